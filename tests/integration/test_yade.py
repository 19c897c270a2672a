"""particles.backend: yade, the real one: a coupled bed, and what becomes of a run whose YADE ends."""

import pathlib
import time
import unittest

from programs import EXIT_PARTICIPANT, EXIT_USAGE, ProgramTest, children, is_alive, kill, small_bed


def yade_bed():
    scene = small_bed()
    scene["particles"]["backend"] = "yade"
    return scene


def children_of(pid):
    return [int(child) for child in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def descendants(pid):
    """Of a process, however far down: YADE keeps a copy of itself while a window is open."""
    found = children_of(pid)
    for child in list(found):
        try:
            found += descendants(child)
        except (FileNotFoundError, ProcessLookupError):
            continue  # ended meanwhile
    return found


class Yade(ProgramTest):
    def test_moves_a_bed_in_a_flow_and_the_audit_holds(self):
        scene = yade_bed()
        # Thrown up, so that some leave through the top of a box this low; others rain in.
        scene["fluid"]["mesh"]["box"]["upper"][2] = 0.03
        scene["fluid"]["mesh"]["box"]["cells"][2] = 6
        scene["particles"]["insertion"][0]["velocity"] = [0, 0, 1.0]
        scene["particles"]["inflow"] = [
            {"within": {"x": [0.005, 0.015], "z": [0.02, 0.028]}, "material": "glass", "diameter": 2.0e-3, "number_rate": 1000}
        ]
        self.run_scene(scene)
        rows = self.audit()
        self.assertEqual(len(rows), 40)
        for row in rows:
            # Round-off of the sums over cells and faces: nothing else is in the balance.
            self.assertLess(abs(row["relative_imbalance"]), 1e-12)
            self.assertLess(row["max_cell_residual"], 1e-12)
            self.assertLess(abs(row["cumulative_drift"]), 1e-12)
        particles = self.results()["particles"]
        last = particles[max(particles, key=int)]
        self.assertGreater(last["id"][-1], 300, "nobody came in")
        self.assertLess(len(last["id"]), int(last["id"][-1]), "nobody left")

    def test_that_is_killed_ends_the_run_with_its_name(self):
        scene = yade_bed()
        scene["scene"]["end_time"] = 1000.0
        process = self.start(scene)
        self.wait_for_windows(process, 3)
        (server,) = children(process, "dem_server")
        (victim,) = children_of(server)
        kill(victim)
        _, stderr = process.communicate(timeout=30)
        self.assertEqual(process.returncode, EXIT_PARTICIPANT, stderr)
        self.assertIn("YADE", stderr)
        self.assertIn("signal 9", stderr)
        self.assertGreaterEqual(len(self.audit()), 3)

    def test_does_not_outlive_a_particle_server_that_is_killed(self):
        scene = yade_bed()
        scene["scene"]["end_time"] = 1000.0
        process = self.start(scene)
        self.wait_for_windows(process, 3)
        (server,) = children(process, "dem_server")
        below = descendants(server)
        (adapter,) = children_of(server)
        endpoint = pathlib.Path(f"/proc/{adapter}/cmdline").read_text().split("\0")[2]
        folder = pathlib.Path(endpoint.removeprefix("ipc://")).parent
        self.assertTrue(folder.is_dir())
        kill(server)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, EXIT_PARTICIPANT)
        deadline = time.monotonic() + 5
        while any(is_alive(pid) for pid in below) and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertFalse(any(is_alive(pid) for pid in below))
        self.assertFalse(folder.exists())

    def test_refuses_what_it_cannot_do_under_the_key_that_asks_for_it(self):
        def refused(key, change):
            scene = yade_bed()
            change(scene)
            _, stderr = self.run_scene(scene, expect=EXIT_USAGE)
            self.assertIn(key, stderr)
            self.assertIn("yade", stderr)

        particles = lambda **keys: lambda scene: scene["particles"].update(keys)
        refused("particles.contact.rolling", lambda scene: scene["particles"]["contact"].update(rolling="constant_torque"))
        refused("particles.numerics.precision", particles(numerics={"precision": "mixed"}))
        refused("particles.numerics.threads", particles(numerics={"threads": 2}))
        refused("particles.ranks", particles(ranks=2))
        refused("particles.surfaces", particles(surfaces={"a": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}))
        refused("fluid.mesh.periodic", lambda scene: scene["fluid"]["mesh"].update(periodic=["x"]))
        other = {**yade_bed()["particles"]["insertion"][0], "diameter": 1.0e-3, "count": 3}
        refused("particles.insertion[1]", lambda scene: scene["particles"]["insertion"].append(other))
        steel = {"within": {"z": [0.05, 0.06]}, "material": "steel", "diameter": 2.0e-3, "number_rate": 10}

        def add_steel(scene):
            scene["particles"]["materials"]["steel"] = {"density": 7800}
            scene["particles"]["inflow"] = [steel]
            scene["particles"]["contact"]["pairs"] += [
                {"between": ["steel", other], "normal_stiffness": 300} for other in ("glass", "steel", "walls")
            ]

        refused("particles.inflow[0]", add_steel)
        # One that stands still may be of any kind.
        scene = yade_bed()
        scene["scene"]["end_time"] = 0.001
        add_steel(scene)
        del scene["particles"]["inflow"]
        scene["particles"]["insertion"].append(
            {"type": "lattice", "material": "steel", "diameter": 1.0e-3, "motion": "fixed", "within": {"z": [0.05, 0.055]}}
        )
        self.run_scene(scene)
