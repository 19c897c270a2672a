"""particles.backend hard_sphere: conservative like every engine, and a fluidised bed as soft spheres have it."""

import unittest

import numpy

from programs import ProgramTest, small_bed
from test_flows import rain


def with_backend(scene, backend):
    scene["particles"]["backend"] = backend
    scene["particles"]["numerics"] = {"threads": 1}
    scene["fluid"]["numerics"] = {"threads": 1}
    return scene


def fluidised_bed(backend):
    """1200 spheres of 2 mm in a flat box, settled and then blown up by 1.6 times what just lifts them."""
    scene = with_backend(small_bed(), backend)
    scene["scene"]["end_time"] = 0.2
    scene["coupling"]["window"] = 1.0e-3
    scene["fluid"]["mesh"] = {
        "box": {"lower": [0, 0, 0], "upper": [0.03, 0.008, 0.15], "cells": [6, 2, 30]},
        "patches": {"inlet": {"side": "z_min"}, "outlet": {"side": "z_max"}},
    }
    scene["fluid"]["boundaries"] = {
        "inlet": {"type": "velocity", "superficial": [0, 0, 2.0]},
        "outlet": {"type": "pressure", "value": 0},
        "walls": {"type": "wall"},
    }
    pairs = scene["particles"]["contact"]["pairs"]
    for pair in pairs:
        pair.update(normal_stiffness=500, restitution=0.9, friction=0.3)
    scene["particles"]["insertion"][0].update(count=1200, within={"z": [0, 0.042]})
    scene["interphase"] = {"forces": ["pressure_gradient"]}
    scene["output"] = {"fields": {"every": 0.01}, "particles": {"every": 0.01}}
    return scene


class HardSphere(ProgramTest):
    def assert_balanced(self, rows):
        for row in rows:
            self.assertLess(abs(row["relative_imbalance"]), 1e-12)
            self.assertLess(row["max_cell_residual"], 1e-12)
            self.assertLess(row["voidage_volume_error"], 1e-12)
            self.assertLess(abs(row["cumulative_drift"]), 1e-12)
            self.assertLess(row["particle_mass_error"], 1e-14)

    def history(self, scene, name):
        """Mean height of the spheres [m] and pressure at the inlet [Pa] over time, and the audit."""
        out = self.folder / name
        self.run_scene(scene, out=out)
        results = self.results(out)
        snapshots = [results["particles"][key] for key in sorted(results["particles"], key=int)]
        height = numpy.array([snapshot["position"][:, 2].mean() for snapshot in snapshots])
        inlet = results["mesh"]["cell_centres"][:, 2] < 0.005  # the lowest layer of cells
        fields = [results["fields"][key] for key in sorted(results["fields"], key=int)]
        pressure = numpy.array([field["pressure"][:][inlet].mean() for field in fields])
        return height, pressure, self.audit(out)

    def test_a_fluidised_bed_is_that_of_soft_spheres(self):
        hard, hard_pressure, rows = self.history(fluidised_bed("hard_sphere"), "hard")
        soft, soft_pressure, _ = self.history(fluidised_bed("native"), "soft")
        self.assert_balanced(rows)
        rise = soft.max() - soft[0]
        print("largest difference of the mean height over its rise:", numpy.abs(hard - soft).max() / rise)
        weight = 1200 * 2250 * numpy.pi / 6 * 8e-9 * 9.81 / (0.03 * 0.008)
        print("mean pressure at the inlet over the weight:", hard_pressure[2:].mean() / weight, soft_pressure[2:].mean() / weight)
        self.assertGreater(rise, 0.01)
        # The two take apart what differs in single collisions only later: they have one way up.
        self.assertLess(numpy.abs(hard - soft).max(), 0.1 * rise)
        self.assertLess(abs(hard_pressure[2:].mean() - soft_pressure[2:].mean()), 0.05 * weight)

    def test_particles_come_and_leave(self):
        self.run_scene(with_backend(rain(), "hard_sphere"))
        rows = self.audit()
        self.assertGreater(sum(row["particles_out"] for row in rows), 100)
        self.assertGreater(sum(row["particles_in"] for row in rows), 100)
        self.assert_balanced(rows)

    def test_momentum_closes_and_two_runs_have_the_same_bits(self):
        results = []
        for name in ("one", "two"):
            scene = with_backend(small_bed(), "hard_sphere")
            for pair in scene["particles"]["contact"]["pairs"]:
                del pair["normal_stiffness"]  # there are no springs
            out = self.folder / name
            self.run_scene(scene, out=out)
            rows = self.audit(out)
            self.assert_balanced(rows)
            particles = self.results(out)["particles"]
            results.append(particles[max(particles, key=int)])
            for row, before in zip(rows[1:], rows):
                for axis in "xyz":
                    # What the fluid lost in one window the particles got in the next.
                    self.assertAlmostEqual(
                        row[f"momentum_to_particles_{axis}"], -before[f"momentum_to_fluid_{axis}"], delta=1e-12 * abs(before["momentum_to_fluid_z"])
                    )
        for what in ("position", "velocity", "spin"):
            self.assertEqual(results[0][what][:].tobytes(), results[1][what][:].tobytes())


if __name__ == "__main__":
    unittest.main()
