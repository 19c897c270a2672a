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
    # RMS difference from the points, by quantity and height [mm]: that of the whole run (docs/mueller2009) and three standard errors of
    # a mean over 1.5 s, up to 0.01 by its blocks of time. An even voidage is off by 0.056 and 0.117, a bed at rest by 0.06, 0.11, 0.17 m/s.
    LIMITS = {
        ("voidage", 16.4): 0.05,
        ("voidage", 31.2): 0.1,
        ("cut", 16.4): 0.05,
        ("cut", 31.2): 0.1,
        ("velocity", 15): 0.055,
        ("velocity", 25): 0.06,
        ("velocity", 35): 0.075,
    }

    def test_voidage_and_velocity_are_near_the_measured_ones(self):
        scene = yaml.safe_load((FOLDER / "bed.yaml").read_text())
        scene["scene"]["end_time"] = self.END
        threads = ["--set", "particles.numerics.threads=1", "--set", "fluid.numerics.threads=1"]  # other tests run beside it
        self.run_scene(scene, *threads, timeout=1400)
        for row in self.audit():
            self.assertLess(abs(row["relative_imbalance"]), CONSERVED, row)
            self.assertEqual(row["particle_count"], 9240)
        compare = comparison()
        found = compare.curves(self.results(), self.START, self.END)
        print("\n" + "\n".join(compare.report(found)))
        for curve in found:
            with self.subTest(f"{curve.quantity} at {curve.height} mm"):
                self.assertLess(curve.rms, self.LIMITS[curve.quantity, curve.height])
                self.assertLess(curve.rms_error, 0.02)  # else the mean says nothing


if __name__ == "__main__":
    unittest.main()
