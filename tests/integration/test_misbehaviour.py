"""A participant that breaks the protocol ends the run with an error that says how; nothing of its window is recorded."""

import subprocess
import unittest

from faulty_participant import FAULT_STEP, Faulty, falls_silent, not_finite, voidage_wrong
from programs import BIN, EXIT_CONSERVATION, EXIT_NUMERICS, EXIT_PARTICIPANT, ProgramTest
from test_python_participant import free_port, porous_block


def voidage_above_one(participant, body, arrays):
    arrays["voidage"][3] = 1.5


def too_short(participant, body, arrays):
    arrays["voidage"] = arrays["voidage"][:-1]


def missing(participant, body, arrays):
    del arrays["impulse_given"]


def number_missing(participant, body, arrays):
    del body["particle_volume"]


def stale_step(participant, body, arrays):
    participant.step -= 1


def lost_message(participant, body, arrays):
    participant.sequence += 1


def foreign_session(participant, body, arrays):
    participant.session = "0" * 16


def says_what_it_may_not(participant, body, arrays):
    return "commit"


def says_what_is_unknown(participant, body, arrays):
    return "resulte"


class Misbehaviour(ProgramTest):
    def provoke(self, fault, expect, *fragments):
        port = free_port()
        endpoint = f"tcp://127.0.0.1:{port}"
        scene = porous_block(port)
        scene["launch"]["deadline"] = 1.5
        process = self.start(scene)
        fluid = subprocess.Popen([BIN / "cfd_server", "--connect", endpoint], stderr=subprocess.DEVNULL)
        self.addCleanup(self.end, fluid)
        solids = Faulty(endpoint, fault)
        thread = solids.serve_in_thread()
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, expect, stderr)
        for fragment in fragments:
            self.assertIn(fragment, stderr)
        self.assertEqual(len(self.audit()), FAULT_STEP - 1)
        self.assertEqual(len(self.results()["audit/step"]), FAULT_STEP - 1)
        thread.join(timeout=10)
        return solids.log

    def test_a_value_that_is_not_finite(self):
        self.provoke(not_finite, EXIT_NUMERICS, "dem_server, step 5", "drag_source", "nan", "row 7")

    def test_a_voidage_above_one(self):
        self.provoke(voidage_above_one, EXIT_NUMERICS, "step 5", "voidage 1.5", "cell 3")

    def test_a_voidage_that_does_not_fit_the_particles(self):
        heard = self.provoke(voidage_wrong, EXIT_CONSERVATION, "voidage_volume_error", "over the limit")
        self.assertEqual(heard[-3:], ["advance", "rollback", "bye"])
        self.assertEqual(heard.count("commit"), FAULT_STEP - 1)

    def test_an_array_of_another_length(self):
        self.provoke(too_short, EXIT_PARTICIPANT, "voidage", "39")

    def test_a_missing_field(self):
        self.provoke(missing, EXIT_PARTICIPANT, "impulse_given", "missing")

    def test_a_missing_number(self):
        self.provoke(number_missing, EXIT_PARTICIPANT, "particle_volume", "missing")

    def test_an_answer_to_another_step(self):
        self.provoke(stale_step, EXIT_PARTICIPANT, "dem_server", "step 4", "expected")

    def test_a_gap_in_the_sequence(self):
        self.provoke(lost_message, EXIT_PARTICIPANT, "dem_server", "sequence")

    def test_another_session(self):
        self.provoke(foreign_session, EXIT_PARTICIPANT, "dem_server", "session 0000000000000000")

    def test_a_message_that_only_the_coordinator_may_say(self):
        self.provoke(says_what_it_may_not, EXIT_PARTICIPANT, "dem_server", "may not say 'commit'")

    def test_an_unknown_message(self):
        self.provoke(says_what_is_unknown, EXIT_PARTICIPANT, "dem_server", "malformed", "resulte")

    def test_silence(self):
        self.provoke(falls_silent, EXIT_PARTICIPANT, "dem_server", "silent for 1.5 s", "advance")


if __name__ == "__main__":
    unittest.main()
