"""What goes wrong ends in a named error, a defined exit code, readable results and no orphan."""

import resource
import signal
import socket
import subprocess
import time
import unittest

from programs import (COORDINATOR, EXIT_DONE, EXIT_INTERRUPTED, EXIT_PARTICIPANT, EXIT_USAGE, ProgramTest, children, is_alive,
                      kill, small_bed)


def long_bed():
    scene = small_bed()
    scene["scene"]["end_time"] = 1000.0
    return scene


class LostParticipant(ProgramTest):
    def lose(self, name, number, scene=None, within=2.0):
        process = self.start(scene or long_bed())
        self.wait_for_windows(process, 5)
        servers = children(process, "cfd_server") + children(process, "dem_server")
        self.assertEqual(len(servers), 2)
        (victim,) = children(process, name)
        kill(victim, number)
        begin = time.monotonic()
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, EXIT_PARTICIPANT, stderr)
        self.assertIn(name, stderr)
        self.assertIn("step", stderr)
        self.assertFalse(any(is_alive(pid) for pid in servers), "an orphan was left")
        self.assertLess(time.monotonic() - begin, within)
        self.assertGreaterEqual(len(self.audit()), 5)
        self.assertEqual(len(self.results()["audit/step"]), len(self.audit()))
        return stderr

    def test_a_killed_fluid_server_is_named_at_once(self):
        self.assertIn("signal 9", self.lose("cfd_server", signal.SIGKILL))

    def test_a_killed_particle_server_is_named_at_once(self):
        self.assertIn("signal 9", self.lose("dem_server", signal.SIGKILL))

    def test_a_stopped_server_is_named_past_its_deadline(self):
        scene = long_bed()
        scene["launch"] = {"deadline": 1.0}
        self.assertIn("silent for 1", self.lose("dem_server", signal.SIGSTOP, scene, within=6.0))

    def test_servers_do_not_outlive_the_coordinator(self):
        process = self.start(long_bed())
        self.wait_for_windows(process, 3)
        servers = children(process, "cfd_server") + children(process, "dem_server")
        process.kill()
        process.communicate()
        deadline = time.monotonic() + 5
        while any(is_alive(pid) for pid in servers) and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertFalse(any(is_alive(pid) for pid in servers))


class Interrupt(ProgramTest):
    def test_ends_after_the_window_with_everything_saved(self):
        process = self.start(long_bed())
        self.wait_for_windows(process, 5)
        process.send_signal(signal.SIGINT)
        stdout, _ = process.communicate(timeout=30)
        self.assertEqual(process.returncode, EXIT_INTERRUPTED)
        rows = self.audit()
        results = self.results()
        self.assertEqual(len(results["audit/step"]), len(rows))
        last = max(results["fields"], key=int)
        self.assertEqual(results["fields"][last].attrs["step"], rows[-1]["step"])
        self.assertIn("gas in / out", stdout)


class Garbage(ProgramTest):
    def test_on_the_port_does_not_disturb_a_run(self):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        scene = small_bed()
        scene["launch"] = {"listen": f"tcp://127.0.0.1:{port}"}
        process = self.start(scene)
        self.wait_for_windows(process, 2)
        for noise in (b"GET / HTTP/1.0\r\n\r\n", b"\x00" * 4096, b"\xff" * 65536, b""):
            with socket.create_connection(("127.0.0.1", port)) as stranger:
                stranger.sendall(noise)
        import zmq

        context = zmq.Context()
        stranger = context.socket(zmq.DEALER)
        stranger.linger = 0
        stranger.connect(f"tcp://127.0.0.1:{port}")
        for frames in ([b""], [b"\xdd\xff\xff\xff\xff"], [b"\x81\xa4type\xa6result"], [b"x"] * 400):
            stranger.send_multipart(frames)
        stdout, stderr = process.communicate(timeout=60)
        context.destroy(linger=0)
        self.assertEqual(process.returncode, EXIT_DONE, stderr)
        self.assertEqual(len(self.audit()), 40)


class BadScene(ProgramTest):
    def refuse(self, scene, *fragments, arguments=(), expect=EXIT_USAGE):
        _, stderr = self.run_scene(scene, *arguments, expect=expect)
        for fragment in fragments:
            self.assertIn(fragment, stderr)

    def test_is_refused_before_anything_starts(self):
        scene = small_bed()
        scene["coupling"]["widnow"] = 1e-4
        self.refuse(scene, "widnow", "window", "scene.yaml:")
        self.assertFalse(self.out.exists(), "something was started")

    def test_names_every_error_at_once(self):
        scene = small_bed()
        scene["fluid"]["density"] = -1
        scene["particles"]["time_step"] = "fast"
        scene["scene"]["end_tmie"] = 3
        self.refuse(scene, "fluid.density", "particles.time_step", "end_tmie")

    def test_a_window_shorter_than_a_particle_step(self):
        scene = small_bed()
        scene["particles"]["time_step"] = 1e-3
        self.refuse(scene, "particles.time_step", "window")

    def test_particles_outside_the_domain(self):
        csv = self.folder / "particles.csv"
        csv.write_text("x,y,z\n0.01,0.005,0.01\n0.01,0.005,0.5\n")
        scene = small_bed()
        scene["particles"]["insertion"] = [{"type": "file", "material": "glass", "diameter": 2e-3, "path": str(csv)}]
        self.refuse(scene, "outside")

    def test_particles_that_overlap(self):
        csv = self.folder / "particles.csv"
        csv.write_text("x,y,z\n0.01,0.005,0.01\n0.0105,0.005,0.01\n")
        scene = small_bed()
        scene["particles"]["insertion"] = [{"type": "file", "material": "glass", "diameter": 2e-3, "path": str(csv)}]
        self.refuse(scene, "overlap")

    def test_an_output_directory_that_cannot_be_written(self):
        (self.folder / "file").write_text("not a folder")
        _, stderr = self.run_scene(small_bed(), expect=EXIT_PARTICIPANT, out=self.folder / "file" / "out")
        self.assertIn(str(self.folder / "file"), stderr)

    def test_a_missing_file(self):
        done = subprocess.run([COORDINATOR, "run", self.folder / "nothing.yaml"], capture_output=True, text=True)
        self.assertEqual(done.returncode, EXIT_USAGE)
        self.assertIn("nothing.yaml", done.stderr)

    def test_check_agrees_and_starts_nothing(self):
        good = subprocess.run([COORDINATOR, "check", self.write_scene(small_bed())], capture_output=True, text=True)
        self.assertEqual(good.returncode, EXIT_DONE, good.stderr)
        scene = small_bed()
        del scene["fluid"]["density"]
        bad = subprocess.run([COORDINATOR, "check", self.write_scene(scene)], capture_output=True, text=True)
        self.assertEqual(bad.returncode, EXIT_USAGE)
        self.assertIn("density", bad.stderr)


class FullDisk(ProgramTest):
    def test_is_an_error_that_names_the_file(self):
        # A limit on the size of files that this run may write stands for a full disk.
        process = subprocess.Popen(
            [COORDINATOR, "run", self.write_scene(small_bed()), "--out", self.out],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000)),
        )
        self.addCleanup(self.end, process)
        _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, EXIT_PARTICIPANT, stderr)
        self.assertIn("results.h5", stderr)
        self.assertGreaterEqual(len((self.out / "audit.csv").read_text().splitlines()), 1)


if __name__ == "__main__":
    unittest.main()
