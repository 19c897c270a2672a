"""Normal runs of the three programs: what they leave behind, over ipc and tcp, and that it is reproducible."""

import unittest
import xml.etree.ElementTree as ElementTree

import h5py
import numpy
import yaml

from programs import EXIT_CONSERVATION, ProgramTest, blown_through, column_vectors, handovers, legacy, small_bed

# Round-off of sums over a few hundred faces and cells of quantities that cancel: some 1e-15; 1e-12 is the promise.
CONSERVED = 1e-12


class NormalRun(ProgramTest):
    def test_leaves_a_complete_record(self):
        stdout, _ = self.run_scene(small_bed())
        rows = self.audit()
        self.assertEqual([row["step"] for row in rows], list(range(1, 41)))
        results = self.results()
        self.assertEqual(len(results["audit/step"]), 40)
        self.assertEqual(sorted(results["fields"]), ["000000", "000001", "000002", "000003", "000004"])
        self.assertEqual(sorted(results["particles"]), ["000000", "000001", "000002"])
        self.assertEqual(results["particles/000002/position"].shape, (300, 3))
        for name in ("scene.yaml", "run.log", "results.xdmf"):
            self.assertTrue((self.out / name).stat().st_size > 0, name)
        for words in ("gas in / out", "largest imbalance", "pressure drop", "particles (DEM)", "exchange + audit", str(self.out)):
            self.assertIn(words, stdout)

    def test_tells_at_its_end_what_mixed_precision_has_cost(self):
        stdout, _ = self.run_scene(small_bed())
        self.assertNotIn("mixed precision", stdout + self.log())
        scene = small_bed()
        scene["particles"].setdefault("numerics", {})["precision"] = "mixed"
        stdout, _ = self.run_scene(scene)
        self.assertIn("mixed precision       off double after one more window: velocities ", stdout)
        self.assertIn("mixed precision against double, one window after the last", self.log())

    def test_starts_a_new_log_in_which_every_process_speaks(self):
        for _ in range(2):
            self.run_scene(small_bed())
            self.assertEqual(self.log().count("started dem_server"), 1)
            for name in ("[coordinator]", "[dem_server]", "[cfd_server]"):
                self.assertIn(name, self.log())

    def test_is_as_quiet_as_asked(self):
        self.run_scene(small_bed(), "--log-level", "error")
        self.assertEqual(self.log(), "")

    def test_conserves_mass_and_momentum_in_every_window(self):
        self.run_scene(small_bed())
        for row in self.audit():
            self.assertLess(abs(row["relative_imbalance"]), CONSERVED, row)
            self.assertLess(row["max_cell_residual"], CONSERVED, row)
            self.assertLess(abs(row["cumulative_drift"]), CONSERVED, row)
            self.assertLess(row["voidage_volume_error"], CONSERVED, row)

    def test_hands_the_particles_what_the_fluid_gave_a_window_before(self):
        self.run_scene(blown_through(small_bed()))
        rows = self.audit()
        lost, given = handovers(rows)
        scale = numpy.abs(lost).max()
        # Sums over cells of impulses whose parts are up to 10 times their sum.
        self.assertLess(numpy.abs(given - lost).max(), CONSERVED * scale)
        self.assertGreater(rows[0]["momentum_to_particles_z"], 0)  # the gas acts from the first window on
        # In flight is what the fluid lost in all, less what the particles have of it.
        balance = -column_vectors(rows, "momentum_to_fluid") - column_vectors(rows, "momentum_to_particles")
        ledger = column_vectors(rows, "ledger")
        self.assertLess(numpy.abs(ledger - balance.cumsum(axis=0)).max(), CONSERVED * scale * len(rows))
        self.assertLess(numpy.abs(ledger[:-1] - lost).max(), CONSERVED * scale * len(rows))

    def test_is_the_same_over_tcp(self):
        self.run_scene(small_bed())
        scene = small_bed()
        scene["launch"] = {"listen": "tcp://127.0.0.1:*"}
        self.run_scene(scene, out=self.folder / "tcp")
        self.assertEqual((self.out / "results.h5").read_bytes(), (self.folder / "tcp" / "results.h5").read_bytes())

    def test_gives_the_same_bits_for_one_and_two_threads_and_again(self):
        for name, threads in (("one", 1), ("two", 2), ("again", 2)):
            scene = small_bed()
            scene["particles"]["numerics"] = {"threads": threads}
            self.run_scene(scene, out=self.folder / name)
        one = (self.folder / "one" / "results.h5").read_bytes()
        self.assertEqual(one, (self.folder / "two" / "results.h5").read_bytes())
        self.assertEqual(one, (self.folder / "again" / "results.h5").read_bytes())

    def test_can_be_repeated_from_the_scene_that_it_recorded(self):
        self.run_scene(small_bed())
        self.run_scene((self.out / "scene.yaml").read_text(), out=self.folder / "again")
        self.assertEqual((self.out / "results.h5").read_bytes(), (self.folder / "again" / "results.h5").read_bytes())


class Tolerance(ProgramTest):
    def test_does_not_touch_conservation(self):
        for tolerance in (1e-2, 1e-4, 1e-8):
            scene = small_bed()
            scene["fluid"]["numerics"] = {"pressure_tolerance": tolerance}
            self.run_scene(scene)
            rows = self.audit()
            self.assertEqual(len(rows), 40)
            for row in rows:
                self.assertLess(abs(row["relative_imbalance"]), CONSERVED, tolerance)
                self.assertLess(row["max_cell_residual"], CONSERVED, tolerance)
            self.assertLess(abs(rows[-1]["cumulative_drift"]), CONSERVED)


class Legacy(ProgramTest):
    def test_loses_per_cents_and_the_audit_sees_it(self):
        scene = legacy(small_bed())
        scene["coupling"]["audit"] = {"on_violation": "warn"}
        stdout, _ = self.run_scene(scene)
        worst = max(abs(row["relative_imbalance"]) for row in self.audit())
        self.assertGreater(worst, 0.01)
        self.assertIn("LEGACY", stdout)
        self.assertIn("AUDIT VIOLATIONS", stdout)

    def test_is_stopped_at_the_last_committed_window(self):
        _, stderr = self.run_scene(legacy(small_bed()), expect=EXIT_CONSERVATION)
        self.assertIn("over the limit", stderr)
        self.assertIn("on_violation: warn", stderr)
        results = self.results()  # readable, and nothing in it that was not committed
        self.assertEqual(len(self.audit()), len(results["audit/step"]))
        self.assertIn("000000", results["fields"])


class VoidageStep(ProgramTest):
    """Steady 1-D flow through a step of the voidage, 0.42 | 1.0 within one cell."""

    def outflow_over_inflow(self, *overrides):
        scene = yaml.safe_load((self.source / "configs/voidage_step.yaml").read_text())
        self.run_scene(scene, *overrides)
        last = self.audit()[-1]
        return last["mass_out"] / last["mass_in"]

    def setUp(self):
        super().setUp()
        from programs import SOURCE

        self.source = SOURCE

    def test_conservative_passes_on_all_gas(self):
        self.assertAlmostEqual(self.outflow_over_inflow(), 1.0, delta=1e-13)

    def test_legacy_loses_what_theory_says(self):
        # Face voidage 0.71: each cell passes on (1-k)/(1+k), k = (eps_e - eps_w)/(2 eps_P); the product is 0.8654.
        lost = self.outflow_over_inflow("--set", "coupling.continuity=legacy", "--set", "coupling.audit.on_violation=warn")
        self.assertAlmostEqual(lost, 0.8654, delta=0.0005)


class Visualisation(ProgramTest):
    """results.xdmf as a reader of XDMF sees it."""

    def test_names_only_datasets_that_exist_with_their_shape(self):
        self.run_scene(small_bed())
        items = list(ElementTree.parse(self.out / "results.xdmf").iter("DataItem"))
        self.assertGreater(len(items), 20)
        with h5py.File(self.out / "results.h5") as results:
            for item in items:
                if item.get("Format") != "HDF":
                    continue
                file, path = item.text.strip().split(":")
                self.assertEqual(file, "results.h5")
                shape = tuple(int(extent) for extent in item.get("Dimensions").split())
                self.assertEqual(numpy.prod(results[path].shape), numpy.prod(shape), path)
                self.assertTrue(item.get("NumberType") and item.get("Precision"), path)

    def test_has_a_time_for_each_record(self):
        self.run_scene(small_bed())
        times = {float(time.get("Value")) for time in ElementTree.parse(self.out / "results.xdmf").iter("Time")}
        for expected in (0.0, 0.005, 0.01, 0.015, 0.02):
            self.assertTrue(any(abs(time - expected) < 1e-9 for time in times), (expected, times))


if __name__ == "__main__":
    unittest.main()
