"""Every map between particles and cells through the whole chain; cells fuller than they may be."""

import unittest

from programs import EXIT_NUMERICS, EXIT_USAGE, ProgramTest, small_bed

MAPS = ["centroid", "satellite", "exact", "kernel", {"map": "kernel", "width": "4 mm"}, {"map": "diffusion", "width": "6 mm"}]


def bed(voidage):
    scene = small_bed()
    scene["scene"]["end_time"] = 0.005
    scene["interphase"] = {"voidage": voidage}
    scene["particles"]["numerics"] = {"threads": 1}
    scene["fluid"]["numerics"] = {"threads": 1}
    return scene


class Maps(ProgramTest):
    def assert_conserved(self, rows):
        for row in rows:
            self.assertLess(abs(row["relative_imbalance"]), 1e-12)
            self.assertLess(row["max_cell_residual"], 1e-12)
            self.assertLess(row["voidage_volume_error"], 1e-13)

    def test_every_map_conserves_mass_and_hands_over_all_momentum(self):
        for voidage in MAPS:
            with self.subTest(voidage=voidage):
                out = self.folder / str(MAPS.index(voidage))
                stdout, _ = self.run_scene(bed(voidage), out=out)  # the gate holds momentum to 1e-10
                self.assert_conserved(self.audit(out))
                self.assertNotIn("over-full cells", stdout)

    def test_what_over_full_cells_pass_on_is_in_the_audit_and_in_the_summary(self):
        # Cells of half a diameter: many lie within spheres.
        scene = bed("exact")
        scene["fluid"]["mesh"]["box"]["cells"] = [20, 10, 60]
        stdout, _ = self.run_scene(scene)
        rows = self.audit()
        self.assert_conserved(rows)
        solids = rows[0]["particle_mass"] / 2250
        for row in rows:
            self.assertGreater(row["excess_moved"], 0.001 * solids)
            self.assertLess(row["excess_moved"], 0.5 * solids)
            self.assertGreaterEqual(row["epsilon_min"], 0.2 - 1e-12)
        self.assertIn("over-full cells", stdout)
        self.assertEqual(list(self.results()["audit/excess_moved"]), [row["excess_moved"] for row in rows])

    def test_a_bed_that_does_not_fit_is_refused_by_cell(self):
        scene = bed({"map": "exact", "smallest": 0.9})
        scene["particles"]["insertion"][0]["within"] = {"z": [0, 0.06]}
        _, stderr = self.run_scene(scene, expect=EXIT_NUMERICS)
        self.assertIn("no cell that could take what is beyond 0.9", stderr + self.log())

    def test_options_of_another_map_are_refused(self):
        _, stderr = self.run_scene(bed({"map": "exact", "points": 20}), expect=EXIT_USAGE)
        self.assertIn("interphase.voidage.points: has no meaning here, only with `map: satellite`", stderr)


if __name__ == "__main__":
    unittest.main()
