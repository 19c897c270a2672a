"""The forces between the phases through the three programs: momentum in every window, and what is on the wire for them."""

import sys
import unittest

from programs import BIN, EXIT_PARTICIPANT, EXIT_USAGE, ProgramTest, handovers, small_bed
from test_python_participant import HERE, free_port, porous_block

CONSERVED = 1e-12  # round-off of sums over some hundred cells and particles

FORCES = ["pressure_gradient", "viscous", "added_mass", "saffman_lift", "magnus_lift", "turbulent_dispersion"]


def bed_in_water(forces):
    """A bed of 300 glass beads that a turbulent jet of water stirs; friction makes them spin."""
    scene = small_bed()
    scene["fluid"].update(density=1000, viscosity=1e-3)
    scene["fluid"]["boundaries"]["jet"]["superficial"] = [0, 0, 0.2]
    scene["fluid"]["boundaries"]["background"]["superficial"] = [0, 0, 0.03]
    scene["interphase"] = {"forces": forces}
    if "added_mass" in forces:
        scene["interphase"]["added_mass_crowding"] = "zuber"
    if "turbulent_dispersion" in forces:
        scene["interphase"]["dispersion_seed"] = 3
        scene["fluid"]["turbulence"] = {
            "model": "k_epsilon",
            "kinetic_energy": 1e-4,
            "dissipation": 1e-3,
            "inlets": {name: {"intensity": 0.05, "length_scale": 1e-3} for name in ("jet", "background")},
        }
    return scene


class Forces(ProgramTest):
    def test_all_at_once_conserve_mass_and_momentum_and_move_the_particles_otherwise(self):
        end = {}
        for name, forces in (("drag", FORCES[:1]), ("all", FORCES)):
            out = self.folder / name
            self.run_scene(bed_in_water(forces), out=out)
            rows = self.audit(out)
            self.assertEqual(len(rows), 40)
            scale = max(abs(row[f"momentum_to_fluid_{axis}"]) for row in rows for axis in "xyz")
            for row in rows:
                self.assertLess(row["max_cell_residual"], CONSERVED)
            lost, given = handovers(rows)
            self.assertLess(abs(given - lost).max(), CONSERVED * scale)
            results = self.results(out)["particles"]
            end[name] = results[max(results, key=int)]["position"][:]
        self.assertGreater(abs(end["all"] - end["drag"]).max(), 1e-6)

    def test_a_participant_without_their_fields_is_refused_with_the_name(self):
        port = free_port()
        endpoint = f"tcp://127.0.0.1:{port}"
        scene = porous_block(port)
        scene["interphase"] = {"forces": ["pressure_gradient", "added_mass"]}
        coordinator = self.start(scene)
        for command in (
            [BIN / "cfd_server", "--connect", endpoint],
            [sys.executable, HERE / "python_participant.py", endpoint, 0.5, 1000.0],
        ):
            self.participant(*command)
        _, stderr = coordinator.communicate(timeout=60)
        self.assertEqual(coordinator.returncode, EXIT_PARTICIPANT, stderr)
        self.assertIn("'pressure_return'", stderr)
        self.assertIn("interphase.forces", stderr)

    def test_dispersion_without_turbulence_is_a_fault_of_the_scene(self):
        scene = bed_in_water(FORCES)
        scene["fluid"].pop("turbulence")
        _, stderr = self.run_scene(scene, expect=EXIT_USAGE)
        self.assertIn("k_epsilon", stderr)


if __name__ == "__main__":
    unittest.main()
