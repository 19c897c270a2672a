"""LAMMPS and LIGGGHTS as the particle side of whole runs."""

import unittest

from programs import EXIT_NUMERICS, EXIT_USAGE, ProgramTest, small_bed

CONSERVED = 1e-12


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

    def test_a_lost_particle_is_named(self):
        scene = self.bed()
        scene["particles"]["outflow"] = []
        scene["particles"]["insertion"] = [
            {"type": "lattice", "material": "glass", "diameter": 2.0e-3, "velocity": [0, 0, 6], "within": {"z": [0.05, 0.06]}}
        ]
        _, stderr = self.run_scene(scene, expect=EXIT_NUMERICS)
        self.assertRegex(stderr, "particle [0-9]+ .*z_max, which is open")


class Lammps(EngineTest, ProgramTest):
    backend = "lammps"
    push = 1e-8  # the same law and steps: round-off, grown by collisions


class Liggghts(EngineTest, ProgramTest):
    backend = "liggghts"
    push = 1e-2  # its friction is another where contacts slip


if __name__ == "__main__":
    unittest.main()
