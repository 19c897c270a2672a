"""coupling.scheme parallel: both sides at once, one window late, conservative all the same."""

import sys
import threading
import unittest

import numpy

from faulty_participant import Faulty, falls_silent, not_finite, voidage_wrong
from programs import (
    BIN,
    EXIT_CONSERVATION,
    EXIT_DONE,
    EXIT_NUMERICS,
    EXIT_PARTICIPANT,
    ProgramTest,
    blown_through,
    column_vectors,
    handovers,
    small_bed,
)
from python_participant import Participant
from test_flows import rain
from test_python_participant import HERE, free_port, porous_block


def parallel(scene):
    scene["coupling"]["scheme"] = "parallel"
    scene["fluid"]["numerics"] = {"threads": 1}
    scene["particles"]["numerics"] = {"threads": 1}
    return scene


class Parallel(ProgramTest):
    def assert_balanced(self, rows):
        for row in rows:
            self.assertLess(abs(row["relative_imbalance"]), 1e-12)
            self.assertLess(row["max_cell_residual"], 1e-12)
            self.assertLess(row["voidage_volume_error"], 1e-12)
            self.assertLess(abs(row["cumulative_drift"]), 1e-12)
        lost, given = handovers(rows)
        scale = numpy.abs(lost).max()
        # Sums over some 100 cells and 300 particles, of terms larger than the sums.
        self.assertLess(numpy.abs(given - lost).max(), 1e-12 * scale)
        # In flight is what the last window handed over, and nothing else.
        self.assertLess(numpy.abs(column_vectors(rows, "ledger")[:-1] - lost).max(), 1e-12 * scale)
        self.assertGreater(scale, 0)

    def test_mass_and_momentum_close_in_every_window(self):
        stdout, _ = self.run_scene(parallel(blown_through(small_bed())))
        rows = self.audit()
        self.assertEqual(len(rows), 40)
        self.assertGreater(rows[0]["momentum_to_particles_z"], 0)  # lent
        self.assert_balanced(rows)
        self.assertIn("in flight at the end", stdout)
        self.assertIn("of these both", stdout)

    def test_with_particles_that_come_and_leave(self):
        self.run_scene(parallel(rain()))
        rows = self.audit()
        self.assertGreater(sum(row["particles_out"] for row in rows), 100)
        self.assert_balanced(rows)
        for row in rows:
            self.assertLess(row["particle_mass_error"], 1e-14)

    def test_the_fluid_has_the_voidage_of_the_window_before(self):
        scene = small_bed()
        scene["scene"]["end_time"] = 0.002
        for what in ("fields", "particles"):
            scene["output"][what]["every"] = scene["coupling"]["window"]
        self.run_scene(parallel(scene))
        fields = self.results()["fields"]
        voidage = [fields[name]["voidage"][:] for name in sorted(fields, key=int)]
        self.assertEqual(len(voidage), 5)
        numpy.testing.assert_array_equal(voidage[1], voidage[0])  # in the first window nothing has moved for it
        for earlier, later in zip(voidage[1:], voidage[2:]):
            self.assertTrue((earlier != later).any())

    def test_two_runs_have_the_same_bits(self):
        scene = parallel(small_bed())
        outs = [self.folder / "one", self.folder / "two"]
        for out in outs:
            scene["output"]["directory"] = "same"
            self.run_scene(scene, out=out)
        files = [self.results(out) for out in outs]
        names = []
        files[0].visit(names.append)
        compared = 0
        for name in names:
            if hasattr(files[0][name], "dtype") and files[0][name].dtype.kind in "fiu":
                self.assertEqual(files[0][name][()].tobytes(), files[1][name][()].tobytes(), name)
                compared += 1
        self.assertGreater(compared, 40)

    def test_the_difference_to_serial_halves_with_the_window(self):
        def positions(scheme, window):
            scene = parallel(small_bed())
            scene["scene"]["end_time"] = 0.004
            scene["coupling"].update(scheme=scheme, window=window)
            scene["particles"]["time_step"] = 1.25e-5
            scene["output"] = {"fields": {"every": 0}, "particles": {"every": 0.004}}
            out = self.folder / f"{scheme}-{window}"
            self.run_scene(scene, out=out)
            particles = self.results(out)["particles"]
            return particles[max(particles, key=int)]["velocity"][:]

        differences = []
        for window in (5.0e-4, 2.5e-4, 1.25e-4):
            apart = positions("parallel", window) - positions("serial", window)
            differences.append(numpy.sqrt((apart**2).sum(axis=1).mean()))
        print("parallel - serial, rms of the velocities:", differences)
        for coarse, fine in zip(differences, differences[1:]):
            self.assertGreater(fine, 0)
            self.assertGreater(coarse / fine, 1.5)  # 2 in the limit; contacts are not smooth
            self.assertLess(coarse / fine, 3.0)


def offer_without_drag(participant, body, arrays):
    del arrays["drag_coefficient"]


def impulse_wrong(participant, body, arrays):
    arrays["impulse_given"][3] *= 1.001


class Partners(ProgramTest):
    """The same with a particle side in another language, which may misbehave."""

    def external(self):
        port = free_port()
        scene = parallel(porous_block(port))
        scene["launch"]["deadline"] = 1.5
        scene["scene"]["end_time"] = 0.05
        return scene, f"tcp://127.0.0.1:{port}"

    def provoke(self, asked, fault, expect, *fragments):
        scene, endpoint = self.external()
        process = self.start(scene)
        fluid = self.participant(BIN / "cfd_server", "--connect", endpoint)
        solids = Faulty(endpoint, fault, asked, offers=True)
        thread = solids.serve_in_thread()
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, expect, stderr)
        for fragment in fragments:
            self.assertIn(fragment, stderr)
        self.assertEqual(len(self.audit()), 4)
        thread.join(timeout=10)
        fluid.wait(timeout=10)
        return solids.log

    def test_a_participant_that_offers_takes_part(self):
        scene, endpoint = self.external()
        process = self.start(scene)
        self.participant(BIN / "cfd_server", "--connect", endpoint)
        solids = Participant(endpoint, voidage=0.5, drag=1000.0, offers=True)
        thread = threading.Thread(target=solids.serve, daemon=True)
        thread.start()
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, EXIT_DONE, stderr)
        self.assertEqual(len(self.audit()), 50)
        thread.join(timeout=10)
        solids.socket.close()
        windows = [kind for kind in solids.log if kind in ("offer", "advance", "commit")]
        self.assertEqual(windows, ["offer", "advance", "commit"] * 50)

    def test_a_participant_that_does_not_offer_is_refused(self):
        scene, endpoint = self.external()
        process = self.start(scene)
        self.participant(BIN / "cfd_server", "--connect", endpoint)
        self.participant(sys.executable, HERE / "python_participant.py", endpoint, 0.5, 1000.0)
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, EXIT_PARTICIPANT, stderr)
        self.assertIn("coupling.scheme: serial", stderr)

    def test_silence_while_the_fluid_works(self):
        self.provoke("advance", falls_silent, EXIT_PARTICIPANT, "dem_server", "silent for 1.5 s", "advance")

    def test_silence_when_asked_for_an_offer(self):
        self.provoke("offer", falls_silent, EXIT_PARTICIPANT, "dem_server", "silent for 1.5 s", "offer")

    def test_an_offer_that_is_not_finite(self):
        heard = self.provoke("offer", not_finite, EXIT_NUMERICS, "dem_server, step 5", "drag_source", "row 7")
        self.assertEqual(heard[-2:], ["offer", "bye"])

    def test_an_offer_without_drag(self):
        self.provoke("offer", offer_without_drag, EXIT_PARTICIPANT, "drag_coefficient", "missing")

    def test_a_voidage_that_does_not_fit_is_refused_in_its_own_window(self):
        heard = self.provoke("advance", voidage_wrong, EXIT_CONSERVATION, "voidage_volume_error")
        self.assertEqual(heard[-4:], ["offer", "advance", "rollback", "bye"])

    def test_an_impulse_that_is_not_what_the_fluid_gave(self):
        heard = self.provoke("advance", impulse_wrong, EXIT_CONSERVATION, "handover_error")
        self.assertEqual(heard[-4:], ["offer", "advance", "rollback", "bye"])

    def test_a_fluid_that_ends(self):
        scene, endpoint = self.external()
        scene["scene"]["end_time"] = 50
        process = self.start(scene)
        fluid = self.participant(BIN / "cfd_server", "--connect", endpoint)
        solids = self.participant(sys.executable, "-c", "import sys; from python_participant import Participant; "
                                  "Participant(sys.argv[1], 0.5, 1000.0, offers=True).serve()", endpoint)
        self.wait_for_windows(process, 5)
        fluid.kill()
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, EXIT_PARTICIPANT, stderr)
        self.assertIn("cfd_server", stderr)
        self.assertGreaterEqual(len(self.audit()), 5)
        solids.wait(timeout=10)


if __name__ == "__main__":
    unittest.main()
