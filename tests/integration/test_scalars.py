"""Scalars through the three programs: constancy, budget, bounds, record; what legacy continuity does to them."""

import unittest

import numpy
import yaml

from programs import EXIT_USAGE, SOURCE, ProgramTest, legacy, small_bed

CONSERVED = 1e-12  # round-off of sums over some hundred cells: some 1e-16 of what is there


def with_scalars():
    scene = small_bed()
    inlets = ("jet", "background", "outlet")
    scene["fluid"]["scalars"] = {
        "uniform": {"diffusivity": 2e-5, "initial": 1, "boundaries": {name: {"value": 1} for name in inlets}},
        "tracer": {
            "diffusivity": 2e-5,
            "boundaries": {"jet": {"value": "t < 0.005 ? 1 : 0"}, "background": {"value": 0}, "outlet": {"value": 0}},
        },
        "temperature": {
            "kind": "temperature",
            "conductivity": 0.026,
            "heat_capacity": 1005,
            "initial": 300,
            "source": 1000,
            "boundaries": {"jet": {"value": 350}, "background": {"value": 300}, "outlet": {"value": 300}, "walls": {"flux": 200}},
        },
    }
    return scene


class Scalars(ProgramTest):
    def test_of_a_moving_bed_stay_uniform_bounded_and_balanced(self):
        stdout, _ = self.run_scene(with_scalars())
        self.assertIn("scalar uniform", stdout)
        rows = self.audit()
        for row in rows:
            for name in ("uniform", "tracer", "temperature"):
                self.assertLess(abs(row[f"scalar_{name}_imbalance"]), CONSERVED, row["step"])
            self.assertLess(abs(row["scalar_uniform_min"] - 1), CONSERVED)
            self.assertLess(abs(row["scalar_uniform_max"] - 1), CONSERVED)
            # The linear solver's tolerance, 1e-10 of what changes in a window.
            self.assertGreater(row["scalar_tracer_min"], -1e-10)
            self.assertLess(row["scalar_tracer_max"], 1 + 1e-10)
            self.assertGreater(row["scalar_temperature_min"], 300 - 1e-7)
        # What was recorded makes the budget of the whole run: in - out + source = what is there now - what was there.
        for name in ("tracer", "temperature"):
            gained = sum(row[f"scalar_{name}_{part}"] * sign for row in rows for part, sign in (("in", 1), ("out", -1), ("source", 1)))
            first, last = self.amount(name, "000000"), self.amount(name, "000004")
            self.assertLess(abs(last - first - gained * 5e-4), CONSERVED * len(rows) * max(first, last), name)
        self.assertGreater(rows[-1]["scalar_tracer_amount"], 0)
        self.assertGreater(rows[-1]["scalar_temperature_source"], 0)

    def amount(self, name, index):
        results = self.results()
        record = results["fields"][index]
        capacity = 1005 if name == "temperature" else 1
        return numpy.sum(capacity * 1.225 * record["voidage"][:] * results["mesh/cell_volumes"][:] * record[f"scalar_{name}"][:])

    def test_are_recorded_with_their_units_and_drawn(self):
        self.run_scene(with_scalars())
        record = self.results()["fields/000004"]
        self.assertEqual(record["scalar_temperature"].attrs["units"], "K")
        self.assertEqual(record["scalar_tracer"].attrs["units"], "1")
        self.assertEqual(self.results()["audit/scalar_temperature_in"].attrs["units"], "W")
        self.assertIn("/fields/000004/scalar_tracer", (self.out / "results.xdmf").read_text())

    def test_drift_with_legacy_continuity(self):
        scene = legacy(with_scalars())
        scene["coupling"]["audit"] = {"on_violation": "warn"}
        self.run_scene(scene)
        rows = self.audit()
        off = max(max(row["scalar_uniform_max"] - 1, 1 - row["scalar_uniform_min"]) for row in rows)
        self.assertGreater(off, 1e-3)
        # Their amount balances all the same: what drifts is the fluid's mass under them.
        self.assertLess(max(abs(row["scalar_uniform_imbalance"]) for row in rows), CONSERVED)

    def test_cost_nothing_where_there_are_none(self):
        self.run_scene(small_bed())
        self.assertFalse([key for key in self.audit()[0] if key.startswith("scalar")])
        self.assertFalse([name for name in self.results()["fields/000000"] if name.startswith("scalar")])

    def test_of_the_example_run(self):
        scene = yaml.safe_load((SOURCE / "configs/tracer.yaml").read_text())
        self.run_scene(scene, "--until", "0.01")
        self.assertLess(max(abs(row["scalar_tracer_imbalance"]) for row in self.audit()), CONSERVED)

    def test_are_refused_where_their_patch_is_unknown(self):
        scene = with_scalars()
        scene["fluid"]["scalars"]["tracer"]["boundaries"]["jetty"] = {"value": 1}
        _, stderr = self.run_scene(scene, expect=EXIT_USAGE)
        self.assertIn("fluid.scalars.tracer.boundaries.jetty", stderr)


class Turbulence(ProgramTest):
    def test_models_run_with_particles_and_conserve_mass(self):
        for model in (
            {"model": "smagorinsky"},
            {
                "model": "k_epsilon",
                "kinetic_energy": 0.01,
                "dissipation": 1,
                "inlets": {name: {"intensity": 0.05, "length_scale": 1e-3} for name in ("jet", "background")},
            },
        ):
            scene = with_scalars()
            scene["fluid"]["turbulence"] = model
            self.run_scene(scene)
            rows = self.audit()
            self.assertEqual(len(rows), 40)
            for row in rows:
                self.assertLess(row["max_cell_residual"], CONSERVED)
                self.assertLess(abs(row["scalar_tracer_imbalance"]), CONSERVED)


if __name__ == "__main__":
    unittest.main()
