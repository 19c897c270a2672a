"""A participant in another language, and a fluid server started by hand: the protocol is what docs/protocol.md says."""

import pathlib
import socket
import sys
import unittest

from programs import BIN, EXIT_DONE, EXIT_PARTICIPANT, ProgramTest

HERE = pathlib.Path(__file__).parent


def porous_block(port):
    return {
        "version": 1,
        "scene": {"name": "porous-block", "gravity": [0, 0, 0], "end_time": 0.2},
        "coupling": {"window": 1.0e-3},
        "fluid": {
            "density": 1.2,
            "viscosity": 1.8e-5,
            "mesh": {
                "box": {"lower": [0, 0, 0], "upper": [0.1, 0.02, 0.02], "cells": [10, 2, 2]},
                "patches": {"inlet": {"side": "x_min"}, "outlet": {"side": "x_max"}},
            },
            "boundaries": {
                "inlet": {"type": "velocity", "superficial": [0.5, 0, 0]},
                "outlet": {"type": "pressure", "value": 0},
                "walls": {"type": "wall", "slip": "free"},
            },
            "numerics": {"pressure_tolerance": 1e-10},
        },
        "particles": {"backend": "kinematic", "time_step": 1.0e-3},
        "launch": {"mode": "external", "listen": f"tcp://127.0.0.1:{port}", "deadline": 5, "start_deadline": 10},
    }


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class PythonParticipant(ProgramTest):
    def test_takes_part_in_a_run(self):
        port = free_port()
        endpoint = f"tcp://127.0.0.1:{port}"
        coordinator = self.start(porous_block(port))
        fluid = self.participant(BIN / "cfd_server", "--connect", endpoint, "--name", "by hand")
        voidage, drag = 0.5, 1000.0
        solids = self.participant(sys.executable, HERE / "python_participant.py", endpoint, voidage, drag)
        _, stderr = coordinator.communicate(timeout=60)
        self.assertEqual(solids.wait(timeout=10), 0, solids.stderr.read() if solids.stderr else "")
        self.assertEqual(fluid.wait(timeout=10), 0)
        self.assertEqual(coordinator.returncode, EXIT_DONE, stderr)
        self.assertEqual(len(self.audit()), 200)
        results = self.results()
        last = results["fields"][max(results["fields"], key=int)]
        # Darcy: eps dp/dx = B/V u with u = U/eps, so dp/dx = -1000 * 0.5 / 0.5^2.
        gradient = (last["pressure"][9] - last["pressure"][0]) / 0.09
        self.assertAlmostEqual(gradient, -drag * 0.5 / voidage**2, delta=1e-6 * 2000)

    def test_a_second_of_the_same_role_is_refused_with_the_reason(self):
        port = free_port()
        endpoint = f"tcp://127.0.0.1:{port}"
        scene = porous_block(port)
        scene["launch"]["start_deadline"] = 3
        coordinator = self.start(scene)
        first = self.participant(BIN / "cfd_server", "--connect", endpoint)
        second = self.participant(BIN / "cfd_server", "--connect", endpoint)
        _, stderr = coordinator.communicate(timeout=60)
        self.assertEqual(coordinator.returncode, EXIT_PARTICIPANT)
        self.assertIn("dem_server did not say hello within 3", stderr)
        said = first.communicate(timeout=40)[1] + second.communicate(timeout=40)[1]
        self.assertIn("the role fluid is taken", said)

    def test_a_foreign_backend_is_refused_with_both_named(self):
        port = free_port()
        endpoint = f"tcp://127.0.0.1:{port}"
        scene = porous_block(port)
        scene["launch"]["start_deadline"] = 2
        coordinator = self.start(scene)
        native = self.participant(BIN / "dem_server", "--connect", endpoint, "--backend", "native")
        coordinator.communicate(timeout=60)
        self.assertEqual(coordinator.returncode, EXIT_PARTICIPANT)
        said = native.communicate(timeout=40)[1]
        self.assertIn("'kinematic'", said)
        self.assertIn("'native'", said)


if __name__ == "__main__":
    unittest.main()
