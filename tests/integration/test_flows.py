"""Particles that come in and leave during a run, and the audit that follows their mass."""

import unittest

import numpy

from programs import EXIT_CONSERVATION, EXIT_NUMERICS, EXIT_USAGE, ProgramTest, handovers, small_bed

DENSITY = 2250


def rain():
    """Spheres of two sizes fall through an upward flow and leave through the pressure patch at the bottom."""
    scene = small_bed()
    scene["scene"].update(name="rain", end_time=0.1)
    scene["coupling"]["window"] = 1.0e-3
    scene["fluid"]["mesh"]["patches"] = {"bottom": {"side": "z_min"}, "top": {"side": "z_max"}}
    scene["fluid"]["boundaries"] = {
        "bottom": {"type": "pressure", "value": 0},
        "top": {"type": "velocity", "superficial": [0, 0, -0.5]},
        "walls": {"type": "wall"},
    }
    particles = scene["particles"]
    particles["time_step"] = 5.0e-6
    particles["numerics"] = {"threads": 1}
    scene["fluid"]["numerics"] = {"threads": 1}
    del particles["insertion"]
    particles["inflow"] = [
        {
            "patch": "top",
            "material": "glass",
            "sizes": {"table": [[1.0e-3, 2], [1.5e-3, 1]]},
            "mass_rate": 0.02,
            "velocity": [0, 0, -1.0],
            "stop": 0.08,
            "seed": 5,
        }
    ]
    scene["output"]["particles"]["every"] = 0.02
    return scene


class Flows(ProgramTest):
    def test_mass_of_particles_and_gas_closes_in_every_window(self):
        self.run_scene(rain())
        rows = self.audit()
        mass_in = numpy.array([row["particle_mass_in"] for row in rows])
        mass_out = numpy.array([row["particle_mass_out"] for row in rows])
        mass = numpy.array([row["particle_mass"] for row in rows])
        count = numpy.cumsum([row["particles_in"] - row["particles_out"] for row in rows])
        numpy.testing.assert_array_equal(count, [row["particle_count"] for row in rows])
        self.assertGreater(sum(row["particles_out"] for row in rows), 100)  # it did rain through
        # Sums of some 1000 terms, each known to 1.1e-16 of itself.
        error = numpy.abs(numpy.cumsum(mass_in - mass_out) - mass) / numpy.cumsum(mass_in)
        self.assertLess(error.max(), 1e-13)
        for row in rows:
            self.assertLess(row["particle_mass_error"], 1e-14)
            self.assertLess(abs(row["relative_imbalance"]), 1e-12)
            self.assertLess(row["max_cell_residual"], 1e-12)
            self.assertLess(row["voidage_volume_error"], 1e-12)
        # What is due less than one particle: the mean rate is exact, and nobody waited.
        heaviest = DENSITY * numpy.pi / 6 * 1.5e-3**3
        due = 0.02 * numpy.minimum([row["time"] for row in rows], 0.08)
        self.assertLess(numpy.abs(due - numpy.cumsum(mass_in)).max(), heaviest * (1 + 1e-6))
        self.assertTrue(all(row["particles_waiting"] == 0 for row in rows))
        # Each came in with its velocity; those that left took a momentum downwards out.
        momentum = sum(row["particle_momentum_in_z"] for row in rows)
        self.assertAlmostEqual(momentum / -mass_in.sum(), 1, delta=1e-13)
        self.assertLess(sum(row["particle_momentum_out_z"] for row in rows), -0.9 * mass_out.sum())

    def test_momentum_handed_to_the_particles_is_exact_while_they_come_and_go(self):
        self.run_scene(rain())
        rows = self.audit()
        for handed, given in zip(*handovers(rows)):
            # The sums are of terms larger than themselves, by up to 100 in this flow.
            self.assertLess(numpy.abs(given - handed).max(), 1e-12 * max(numpy.abs(handed).max(), 1e-9))

    def test_results_are_the_same_bits_for_one_and_two_threads(self):
        for threads in (1, 2):
            scene = rain()
            scene["particles"]["numerics"] = {"threads": threads}
            scene["fluid"]["numerics"] = {"threads": threads}
            self.run_scene(scene, out=self.folder / f"out{threads}")
        one, two = self.results(self.folder / "out1"), self.results(self.folder / "out2")
        self.assertGreater(len(one["particles"]), 4)
        for group in ("audit", "particles", "fields"):
            names = []
            one[group].visit(names.append)
            for name in names:
                if hasattr(one[group][name], "shape"):
                    self.assertEqual(one[group][name][()].tobytes(), two[group][name][()].tobytes(), f"{group}/{name}")

    def test_particles_without_room_wait_and_come_later(self):
        scene = rain()
        scene["scene"]["end_time"] = 0.04
        flow = scene["particles"]["inflow"][0]
        # 8 times what the patch takes in a window of 1 ms at 1 m/s, for a hundredth of a second.
        flow.update(mass_rate=1.0, stop=0.004, velocity=[0, 0, -1.0])
        self.run_scene(scene)
        rows = self.audit()
        waiting = [row["particles_waiting"] for row in rows]
        self.assertGreater(max(waiting), 0)
        self.assertEqual(waiting[-1], 0)
        heaviest = DENSITY * numpy.pi / 6 * 1.5e-3**3
        total = sum(row["particle_mass_in"] for row in rows)
        self.assertLess(abs(total - 0.004), heaviest * (1 + 1e-6))
        self.assertIn("wait", self.log())

    def test_an_empty_outflow_keeps_todays_strictness(self):
        scene = rain()
        scene["particles"]["outflow"] = []
        _, stderr = self.run_scene(scene, expect=EXIT_NUMERICS)
        self.assertIn("z_min", stderr)

    def test_columns_are_there_only_if_particles_can_flow(self):
        scene = small_bed()
        scene["scene"]["end_time"] = 0.001
        scene["particles"]["outflow"] = []
        self.run_scene(scene)
        self.assertNotIn("particles_in", self.audit()[0])
        self.assertNotIn("particles_in", self.results()["audit"])

    def test_errors_name_what_is_wrong(self):
        scene = rain()
        scene["particles"]["outflow"] = ["top"]
        scene["particles"]["inflow"][0]["number_rate"] = 3
        _, stderr = self.run_scene(scene, expect=EXIT_USAGE)
        self.assertIn("particles.outflow[0]: `top` is of type velocity", stderr)
        self.assertIn("exactly one of `mass_rate`, `number_rate`", stderr)


if __name__ == "__main__":
    unittest.main()
