"""An engine from outside the tree: our package is installed, a project that knows nothing else is built on it, and its server runs."""

import subprocess

import numpy

import programs
from programs import BIN, EXIT_USAGE, SOURCE, ProgramTest, small_bed


class ThirdParty(ProgramTest):
    def test_program_with_an_engine_of_its_own_moves_the_particles_of_a_scene(self):
        installed, built = self.folder / "installed", self.folder / "built"

        def cmake(*words):
            done = subprocess.run(["cmake", *map(str, words)], capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

        cmake("--install", BIN.parent, "--prefix", installed)
        cmake("-S", SOURCE / "tests" / "third_party_engine", "-B", built, f"-DCMAKE_PREFIX_PATH={installed}",
              "-DCMAKE_CXX_FLAGS=-Wall -Wextra")  # not optimised: it is soon compiled and does little
        cache = (built / "CMakeCache.txt").read_text()
        self.assertIn(f"fluxpact_DIR:PATH={installed}", cache)
        self.assertNotIn(f"{SOURCE}/proto", cache)
        cmake("--build", built)

        programs.COORDINATOR = installed / "bin" / "coordinator"
        self.addCleanup(setattr, programs, "COORDINATOR", BIN / "coordinator")
        scene = small_bed()
        scene["coupling"]["window"] = 1e-3
        scene["particles"].update(backend="custom", program=str(built / "ballistic_server"), time_step=1e-3)
        del scene["particles"]["contact"]
        scene["particles"]["insertion"][0].update(count=100, velocity=[0.5, 0, 0])
        self.run_scene(scene)
        rows = self.audit()
        self.assertEqual(len(rows), 20)
        for row in rows:
            self.assertLess(abs(row["relative_imbalance"]), 1e-12)  # round-off of sums over cells and faces
            self.assertLess(row["max_cell_residual"], 1e-12)
        particles = self.results()["particles"]
        velocity = particles[max(particles, key=int)]["velocity"][:]
        # 10 mm in 20 ms through a box of 20 mm, which holds spheres of 2 mm: about half have met the wall, and lost a fifth there.
        # The gas, 3 m/s at most, changes the speed along x by less than a tenth meanwhile.
        back = velocity[:, 0] < 0
        self.assertTrue(20 < back.sum() < 80, back.sum())
        self.assertLess(numpy.abs(velocity[back, 0] + 0.4).max(), 0.05)
        self.assertLess(numpy.abs(velocity[~back, 0] - 0.5).max(), 0.05)

        scene["particles"]["contact"] = small_bed()["particles"]["contact"]
        _, stderr = self.run_scene(scene, expect=EXIT_USAGE, out=self.folder / "refused")
        self.assertIn("ballistic_server pass through each other", stderr)
