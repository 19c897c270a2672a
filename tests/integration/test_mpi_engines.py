"""LAMMPS and LIGGGHTS as the particle side of whole runs."""

import pathlib
import time
import unittest

from programs import EXIT_NUMERICS, EXIT_USAGE, ProgramTest, is_alive, small_bed

CONSERVED = 1e-12


def living(mark):
    """The processes of a run whose environment has this mark."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and mark.encode() in (entry / "environ").read_bytes() and is_alive(entry.name):
                found.append(entry.name)
        except (FileNotFoundError, ProcessLookupError, PermissionError):
            continue
    return found


class EngineTest:
    """The same for both; the name of the engine is the class's."""

    backend = ""

    def bed(self, backend=None):
        scene = small_bed()
        scene["particles"]["backend"] = backend or self.backend
        return scene

    def run_in(self, folder, scene, *arguments, **options):
        self.out = self.folder / folder
        self.run_scene(scene, *arguments, **options)
        return self.audit(), self.results()

    def test_a_small_bed_conserves_and_is_beside_the_native_engine(self):
        rows, results = self.run_in("engine", self.bed())
        self.assertEqual(len(rows), 40)
        for row in rows:
            self.assertLess(abs(row["relative_imbalance"]), CONSERVED)
            self.assertLess(row["max_cell_residual"], CONSERVED)
            self.assertLess(row["voidage_volume_error"], CONSERVED)
        native, beside = self.run_in("native", self.bed("native"))
        self.assertEqual([row["particle_mass"] for row in rows], [row["particle_mass"] for row in native])
        early = [abs(a["momentum_to_particles_z"] / b["momentum_to_particles_z"] - 1) for a, b in zip(rows[1:], native[1:])]
        print(f"{self.backend}: the fluid's push on all particles differs by {max(early):.1e} at most in 40 windows")
        self.assertLess(max(early), self.push)
        self.assertEqual(sorted(results), sorted(beside))

    def test_two_ranks_agree_with_one(self):
        scene = self.bed()
        scene["particles"]["outflow"] = []
        scene["scene"]["end_time"] = 0.01
        scene["output"] = {"fields": {"every": 0.0005}, "particles": {"every": 0.0005}}
        alone = self.run_in("alone", scene)[1]
        scene["particles"]["ranks"] = 2
        rows, shared = self.run_in("shared", scene)
        self.assertLess(max(abs(row["relative_imbalance"]) for row in rows), CONSERVED)
        # At time 0 nothing has moved: sums in another order. Then round-off grows by collisions.
        for index, bound in ((0, 1e-14), (1, 1e-9)):
            for name in ("voidage", "drag_coefficient", "particle_velocity", "velocity"):
                one, two = (file[f"fields/{index:06d}/{name}"][()] for file in (alone, shared))
                self.assertLess(abs(one - two).max(), bound * max(abs(one).max(), 1e-30), f"{name} {index}")
            self.assertTrue((alone[f"particles/{index:06d}/id"][()] == shared[f"particles/{index:06d}/id"][()]).all())

    def test_an_error_on_two_ranks_is_told_and_ends_both(self):
        scene = self.lost_particle()
        scene["particles"]["ranks"] = 2
        mark = f"FLUXPACT_TEST={self.folder}"
        _, stderr = self.run_scene(scene, expect=EXIT_NUMERICS, environment=dict([mark.split("=")]))
        self.assertRegex(stderr, "particle [0-9]+ .*z_max, which is open")
        deadline = time.monotonic() + 10
        while living(mark) and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertEqual(living(mark), [])

    def test_check_names_what_the_engine_cannot_do(self):
        scene = self.bed()
        scene["particles"]["contact"]["rolling"] = "constant_torque"
        for pair in scene["particles"]["contact"]["pairs"]:
            pair["rolling_friction"] = 0.01
        scene["particles"]["numerics"] = {"precision": "mixed"}
        _, stderr = self.run_scene(scene, expect=EXIT_USAGE)
        self.assertIn("particles.contact.rolling", stderr)
        self.assertIn("particles.numerics.precision", stderr)
        self.assertIn(f"particles.backend: {self.backend}", stderr)

    def lost_particle(self):
        scene = self.bed()
        scene["particles"]["outflow"] = []
        scene["particles"]["insertion"] = [
            {"type": "lattice", "material": "glass", "diameter": 2.0e-3, "velocity": [0, 0, 6], "within": {"z": [0.05, 0.06]}}
        ]
        return scene

    def test_a_lost_particle_is_named(self):
        _, stderr = self.run_scene(self.lost_particle(), expect=EXIT_NUMERICS)
        self.assertRegex(stderr, "particle [0-9]+ .*z_max, which is open")


class Lammps(EngineTest, ProgramTest):
    backend = "lammps"
    push = 1e-8  # the same law and steps: round-off, grown by collisions


class Liggghts(EngineTest, ProgramTest):
    backend = "liggghts"
    push = 1e-2  # its friction is another where contacts slip


if __name__ == "__main__":
    unittest.main()
