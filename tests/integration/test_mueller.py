"""The first seconds of configs/mueller2009/bed.yaml beside what was measured (docs/mueller2009 has the whole run)."""

import importlib.util
import unittest

import yaml

from programs import SOURCE, ProgramTest

FOLDER = SOURCE / "configs" / "mueller2009"

# Round-off of sums over some hundred faces and cells; 1e-12 is the promise.
CONSERVED = 1e-12


def comparison():
    """configs/mueller2009/compare.py as a module."""
    spec = importlib.util.spec_from_file_location("compare", FOLDER / "compare.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class MeasuredBed(ProgramTest):
    START, END = 0.5, 2.0  # [s]

    def test_voidage_and_velocity_are_near_the_measured_ones(self):
        scene = yaml.safe_load((FOLDER / "bed.yaml").read_text())
        scene["scene"]["end_time"] = self.END
        self.run_scene(scene, timeout=1400)
        for row in self.audit():
            self.assertLess(abs(row["relative_imbalance"]), CONSERVED, row)
            self.assertEqual(row["particle_count"], 9240)
        compare = comparison()
        found = compare.curves(self.results(), self.START, self.END)
        print("\n" + "\n".join(compare.report(found)))
        for curve in found:
            with self.subTest(f"{curve.quantity} at {curve.height} mm"):
                self.assertLess(curve.rms, self.LIMITS[curve.quantity] + 2 * curve.rms_error)


if __name__ == "__main__":
    unittest.main()
