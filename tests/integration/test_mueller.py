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
    # [s] In the first second and a half the bed is on its way from its packing.
    START, END = 1.5, 3.0
    # RMS difference from the points, by quantity and height [mm]. 14 spans of 1.5 s of two runs of 12 s, of two packings, have 0.038, 0.043, 0.070, 0.068,
    # 0.041, 0.039 and 0.047 m/s in the mean, and standard deviations of 0.007, 0.009, 0.010, 0.011, 0.015, 0.011 and 0.010 m/s within a run: each processor
    # rounds its way into other bubbles. Four of these above the mean. A bed at rest is off by 0.19 and 0.22 in voidage, 0.059, 0.108 and 0.175 m/s in velocity.
    LIMITS = {
        ("voidage", 16.4): 0.067,
        ("cut", 16.4): 0.078,
        ("voidage", 31.2): 0.111,
        ("cut", 31.2): 0.113,
        ("velocity", 15): 0.100,
        ("velocity", 25): 0.084,
        ("velocity", 35): 0.085,
    }

    # Share of the measured circulation, by height [mm]: the same spans have 0.87, 1.06 and 0.90 in the mean, and 0.164, 0.118 and 0.077 within a run. Four of
    # these to either side; a bed at rest has 0, and in velocity at 15 mm less than the rms difference above.
    SHARES = {15: (0.21, 1.53), 25: (0.59, 1.54), 35: (0.58, 1.21)}

    def test_voidage_and_velocity_are_near_the_measured_ones(self):
        scene = yaml.safe_load((FOLDER / "bed.yaml").read_text())
        scene["scene"]["end_time"] = self.END
        threads = ["--set", "particles.numerics.threads=1", "--set", "fluid.numerics.threads=1"]  # other tests run beside it
        self.run_scene(scene, *threads, timeout=1400)
        for row in self.audit():
            self.assertLess(abs(row["relative_imbalance"]), CONSERVED, row)
            self.assertEqual(row["particle_count"], 9240)
        compare = comparison()
        found = compare.curves([self.results()], self.START, self.END)
        print("\n" + "\n".join(compare.report(found)))
        for curve in found:
            with self.subTest(f"{curve.quantity} at {curve.height} mm"):
                self.assertLess(curve.rms, self.LIMITS[curve.quantity, curve.height])
                self.assertLess(curve.rms_error, 0.02)  # else the mean says nothing
                if curve.quantity == "velocity":
                    low, high = self.SHARES[curve.height]
                    self.assertGreater(curve.share, low)
                    self.assertLess(curve.share, high)


if __name__ == "__main__":
    unittest.main()
