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
    # RMS difference from the points, by quantity and height [mm]: 0.044, 0.075, 0.022, 0.032 and 0.068 m/s in this span, and three standard
    # errors of it (0.008, 0.009, 0.004, 0.008, 0.012 m/s, by ten blocks of time), as another processor rounds the way into other bubbles.
    # A bed at rest is off by 0.19, 0.22, 0.059, 0.108 and 0.175 m/s.
    LIMITS = {
        ("voidage", 16.4): 0.07,
        ("voidage", 31.2): 0.10,
        ("cut", 16.4): 0.075,
        ("cut", 31.2): 0.105,
        ("velocity", 15): 0.035,
        ("velocity", 25): 0.056,
        ("velocity", 35): 0.104,
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
