"""The scene of `make run`, whole: what the project promises of it."""

import unittest

from programs import EXIT_CONSERVATION, SOURCE, ProgramTest, handovers

CONSERVED = 1e-12
QUICKSTART = (SOURCE / "configs" / "quickstart.yaml").read_text()


class Quickstart(ProgramTest):
    def test_conserves_in_every_window_at_any_pressure_tolerance(self):
        # Whole at 1e-4; through the rise of the bed and its first bubbles at the others.
        for tolerance, windows in (("1e-2", 200), ("1e-4", 1000), ("1e-8", 200)):
            settings = ["--set", f"fluid.numerics.pressure_tolerance={tolerance}", "--until", str(windows * 1e-3)]
            stdout, _ = self.run_scene(QUICKSTART, *settings, timeout=600)
            print(f"pressure tolerance {tolerance}{stdout}")
            rows = self.audit()
            self.assertEqual(len(rows), windows)
            self.assertLess(max(abs(row["relative_imbalance"]) for row in rows), CONSERVED)
            self.assertLess(max(row["max_cell_residual"] for row in rows), CONSERVED)
            self.assertLess(max(row["voidage_volume_error"] for row in rows), CONSERVED)
            self.assertLess(abs(rows[-1]["cumulative_drift"]), CONSERVED)
            self.check_momentum(rows)

    def check_momentum(self, rows):
        """What the fluid gave in a window the particles get in the next, in each and in all of them together."""
        lost, given = handovers(rows)
        scale = max(abs(row["momentum_to_fluid_z"]) for row in rows)
        self.assertLess(abs(given - lost).max(), CONSERVED * scale)
        self.assertLess(abs((given - lost).sum(axis=0)).max(), CONSERVED * scale * len(rows))


class QuickstartLegacy(ProgramTest):
    SCENE = (SOURCE / "configs" / "quickstart_legacy.yaml").read_text()

    def test_loses_per_cents_and_the_audit_sees_it(self):
        stdout, _ = self.run_scene(self.SCENE, timeout=600)
        print(stdout)
        worst = max(abs(row["relative_imbalance"]) for row in self.audit())
        self.assertGreater(worst, 0.01)
        self.assertLess(worst, 1.0)

    def test_is_stopped_by_the_gate(self):
        self.run_scene(self.SCENE, "--set", "coupling.audit.on_violation=stop", expect=EXIT_CONSERVATION)
        self.assertEqual(len(self.results()["audit/step"]), len(self.audit()))


if __name__ == "__main__":
    unittest.main()
