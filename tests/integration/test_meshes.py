"""Scenes on meshes from files: run, recorded, repeated, refused."""

import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

import numpy
import yaml

from programs import COORDINATOR, EXIT_DONE, EXIT_USAGE, SOURCE, ProgramTest

MESHES = SOURCE / "tests" / "data" / "meshes"

# Round-off of sums over some thousand faces and cells of quantities that cancel: some 1e-15; 1e-12 is the promise.
CONSERVED = 1e-12


def closed_box(mesh, patches):
    """A fluid at rest, with gravity, in whatever a mesh bounds."""
    return {
        "version": 1,
        "scene": {"name": "at-rest", "end_time": 0.003},
        "coupling": {"window": 1.0e-3},
        "fluid": {
            "density": 1.2,
            "viscosity": 1.8e-5,
            "mesh": mesh,
            "boundaries": {patch: {"type": "wall"} for patch in patches},
        },
    }


KINDS = {
    "tetrahedra": ({"gmsh": {"path": str(MESHES / "tetrahedra.msh"), "scale": 0.01}}, ("inlet", "outlet", "walls")),
    "prisms": ({"gmsh": {"path": str(MESHES / "prisms.msh"), "scale": 0.05}}, ("inlet", "outlet", "pipe")),
    "mixed": ({"gmsh": {"path": str(MESHES / "mixed.msh")}}, ("walls",)),
    "polyhedra": ({"polymesh": {"path": str(MESHES / "polyhedra")}}, ("inlet", "outlet", "sides")),
    "cyclic": ({"polymesh": {"path": str(MESHES / "graded_cyclic")}}, ("inlet", "outlet", "sides")),
    "joined": (
        {"gmsh": {"path": str(MESHES / "hexahedra.msh"), "periodic": [{"patches": ["left", "right"]}]}},
        ("bottom", "walls"),
    ),
}


def volumes_by_divergence(mesh):
    """Cell volumes from the recorded points and faces alone: the integral of x/3 over the triangles of each face."""
    points = mesh["points"][:]
    offsets, ring = mesh["face_offsets"][:], mesh["face_points"][:]
    owner, neighbour = mesh["owner"][:], mesh["neighbour"][:]
    volumes = numpy.zeros(len(mesh["cell_volumes"]))
    for face in range(len(owner)):
        corners = points[ring[offsets[face] : offsets[face + 1]]]
        middle = corners.mean(axis=0)
        area = 0.5 * numpy.cross(corners - middle, numpy.roll(corners, -1, axis=0) - middle).sum(axis=0)
        volumes[owner[face]] += area @ middle / 3
        if face < len(neighbour):
            volumes[neighbour[face]] -= area @ middle / 3
    return volumes


def pipe_scene():
    """configs/bed_in_a_pipe.yaml, to be run from anywhere."""
    scene = yaml.safe_load((SOURCE / "configs/bed_in_a_pipe.yaml").read_text())
    scene["fluid"]["mesh"]["gmsh"]["path"] = str(SOURCE / "configs/meshes/pipe.msh")
    return scene


def ergun(voidage, diameter, viscosity, density, velocity):
    """Pressure drop per length [Pa/m]."""
    return (
        150 * (1 - voidage) ** 2 / voidage**3 * viscosity * velocity / diameter**2
        + 1.75 * (1 - voidage) / voidage**3 * density * velocity**2 / diameter
    )


class MeshFiles(ProgramTest):
    def test_a_prescribed_bed_in_a_pipe_has_the_pressure_drop_of_ergun(self):
        scene = pipe_scene()
        del scene["particles"]
        scene["interphase"] = {"voidage": "prescribed", "drag": "ergun"}
        scene["interphase"]["prescribed"] = {"voidage": "z < 0.05 ? 0.45 : 1", "diameter": 2e-3}
        scene["output"] = {"fields": {"every": 0.05}}
        stdout, _ = self.run_scene(scene)
        self.assertIn("pressure drop", stdout)
        for row in self.audit():
            self.assertLess(abs(row["relative_imbalance"]), CONSERVED, row)
            self.assertLess(row["max_cell_residual"], CONSERVED, row)
        results = self.results()
        record = results["fields"][sorted(results["fields"])[-1]]
        z = results["mesh/cell_centres"][:, 2]
        lowest, highest = z < z.min() + 1e-6, z > z.max() - 1e-6
        drop = record["pressure"][:][lowest].mean() - record["pressure"][:][highest].mean()
        voidage, diameter, viscosity, density, velocity = 0.45, 2e-3, 1.8e-5, 1.2, 0.4
        recovered = density * velocity**2 * (1 / voidage - 1)  # the gas slows down where it leaves the bed
        # 1-D flow on layers: what is left is the pressure tolerance of the solver, 1e-6, over some hundred windows.
        expected = ergun(voidage, diameter, viscosity, density, velocity) * (0.05 - z.min()) - recovered
        self.assertLess(abs(drop - expected), 1e-3 * expected)
        inside = numpy.where(z < 0.05, velocity / voidage, velocity)
        self.assertLess(numpy.abs(record["velocity"][:, 2] - inside).max(), 1e-3)
        self.assertLess(numpy.abs(record["velocity"][:, :2]).max(), 1e-3)

    def test_a_bed_of_spheres_rests_in_a_pipe(self):
        self.run_config("bed_in_a_pipe")
        for row in self.audit():
            self.assertLess(abs(row["relative_imbalance"]), CONSERVED, row)
            self.assertLess(row["max_cell_residual"], CONSERVED, row)
        results = self.results()
        bed = results["particles"][sorted(results["particles"])[-1]]
        position, velocity, radius = bed["position"][:], bed["velocity"][:], bed["radius"][:]
        self.assertEqual(len(radius), 2000)
        # In the pipe and above the inlet, up to the overlap under the weight of the bed: 2000 spheres stand on some 100 with 20 m g
        # each, 7e-3 N or 7e-6 m; some carry a few times that.
        reach = numpy.hypot(position[:, 0], position[:, 1]) + radius
        self.assertLess(reach.max(), 0.025 + 5e-5)
        self.assertGreater((position[:, 2] - radius).min(), -5e-5)
        # 2000 spheres fill 14.4 mm of the pipe, and a random packing 0.5 to 0.64 of its volume.
        self.assertLess(position[:, 2].max() + 1.5e-3, 0.0144 / 0.5 + 3e-3)
        self.assertLess(numpy.median(numpy.linalg.norm(velocity, axis=1)), 1e-3)
        self.check_drop_in_bed(results)

    def check_drop_in_bed(self, results):
        """Between two layers of cells within the bed of 3 mm spheres, 10 mm apart."""
        record = results["fields"][sorted(results["fields"])[-1]]
        z, volumes = results["mesh/cell_centres"][:, 2], results["mesh/cell_volumes"][:]
        layers = [numpy.abs(z - height) < 1e-6 for height in (0.0125, 0.0175, 0.0225)]
        pressure = [record["pressure"][:][layer].mean() for layer in layers]
        voidage = [numpy.average(record["voidage"][:][layer], weights=volumes[layer]) for layer in layers]
        slopes = [ergun(e, 3e-3, 1.8e-5, 1.2, 0.4) for e in voidage]
        expected = 0.005 * (0.5 * slopes[0] + slopes[1] + 0.5 * slopes[2])
        # The bed is looser at the wall, and more air flows there; were it free to, the drop would be 3 % less than in an even bed.
        self.assertLess(abs(pressure[0] - pressure[2] - expected), 0.03 * expected)

    def run_config(self, name):
        path = SOURCE / "configs" / f"{name}.yaml"
        command = [COORDINATOR, "run", path, "--out", self.out]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, EXIT_DONE, f"{done.stdout}\n{done.stderr}\n{self.log()}")
        return done.stdout, done.stderr

    def test_the_recorded_scene_repeats_the_run(self):
        scene = pipe_scene()
        scene["fluid"]["mesh"]["gmsh"]["path"] = "pipe.msh"
        scene["scene"]["end_time"] = 0.02
        (self.folder / "pipe.msh").write_text((SOURCE / "configs/meshes/pipe.msh").read_text())
        self.run_scene(scene)
        again = self.folder / "elsewhere"
        self.run_scene((self.out / "scene.yaml").read_text(), out=again)
        first, second = self.results(), self.results(again)
        last = sorted(first["fields"])[-1]
        for name in first["fields"][last]:
            self.assertTrue(numpy.array_equal(first["fields"][last][name][:], second["fields"][last][name][:]), name)
        last = sorted(first["particles"])[-1]
        for name in first["particles"][last]:
            self.assertTrue(numpy.array_equal(first["particles"][last][name][:], second["particles"][last][name][:]), name)

    def test_a_fluid_at_rest_stays_at_rest_on_cells_of_every_kind(self):
        for kind, (mesh, patches) in KINDS.items():
            with self.subTest(kind):
                self.run_scene(closed_box(mesh, patches), out=self.folder / kind)
                results = self.results(self.folder / kind)
                record = results["fields"][sorted(results["fields"])[-1]]
                self.assertEqual(numpy.abs(record["velocity"][:]).max(), 0.0)
                self.assertEqual(numpy.abs(record["face_flux"][:]).max(), 0.0)

    def test_the_record_holds_the_mesh(self):
        for kind in ("tetrahedra", "prisms", "mixed", "polyhedra"):
            with self.subTest(kind):
                self.run_scene(closed_box(*KINDS[kind]), out=self.folder / kind)
                results = self.results(self.folder / kind)
                volumes = results["mesh/cell_volumes"][:]
                # Round-off of some 10 faces a cell; the volumes of the smallest cells are 1e-2 of the pyramids they are made of.
                self.assertLess((numpy.abs(volumes_by_divergence(results["mesh"]) - volumes) / volumes).max(), 1e-12)
                self.check_drawing(results, self.folder / kind / "results.xdmf")

    def check_drawing(self, results, xdmf):
        """The polyhedra of XDMF: type 16, faces, and for each its points."""
        topology = next(ElementTree.parse(xdmf).iter("Topology"))
        path = topology.find("DataItem").text.strip().split(":")[1]
        numbers = results[path][:]
        cells, faces, at = 0, 0, 0
        while at < len(numbers):
            self.assertEqual(numbers[at], 16)
            count, at = numbers[at + 1], at + 2
            for _ in range(count):
                at += 1 + numbers[at]
            cells, faces = cells + 1, faces + count
        mesh = results["mesh"]
        self.assertEqual(cells, int(topology.get("NumberOfElements")))
        self.assertEqual(cells, len(mesh["cell_volumes"]))
        self.assertEqual(faces, len(mesh["owner"]) + len(mesh["neighbour"]))


class MeshChecks(ProgramTest):
    def check(self, scene, expect=EXIT_DONE):
        done = subprocess.run([COORDINATOR, "check", self.write_scene(scene)], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, expect, f"{done.stdout}\n{done.stderr}")
        return done.stdout if expect == EXIT_DONE else done.stderr

    def test_check_prints_the_quality_and_run_logs_it(self):
        scene = closed_box(*KINDS["polyhedra"])
        text = self.check(scene)
        # 27.2 degrees is what checkMesh of OpenFOAM says of this mesh.
        for words in ("45 cells", "sides 96", "non-orthogonality", "27.2", "skewness", "volume ratio", "aspect ratio", "cell size"):
            self.assertIn(words, text)
        self.run_scene(scene)
        self.assertRegex(self.log(), r"\[coordinator\] info: mesh: 45 cells .*non-orthogonality 27.2 deg")

    def test_check_warns_beyond_70_degrees(self):
        mesh = {"gmsh": {"path": "steep.msh"}}
        text = (MESHES / "hexahedra.msh").read_text().splitlines()
        # The format keeps nodes after `$Nodes`, one a line: shear them all, x += 4 z.
        start, end = text.index("$Nodes"), text.index("$EndNodes")
        for i in range(start, end):
            numbers = text[i].split()
            if len(numbers) == 3:
                x, y, z = map(float, numbers)
                text[i] = f"{x + 4 * z} {y} {z}"
        (self.folder / "steep.msh").write_text("\n".join(text) + "\n")
        scene = closed_box(mesh, ("bottom", "left", "right", "walls"))
        self.assertRegex(self.check(scene), r"warning: \d+ faces are beyond 70 degrees, the worst at ")

    def test_check_tells_the_cell_size_of_particles(self):
        scene = closed_box({"box": {"upper": [1, 1, 1], "cells": [10, 10, 10], "grading": {"z": [{"ratio": 4}]}}}, ("walls",))
        scene["particles"] = {
            "time_step": 1.0e-5,
            "materials": {"glass": {"density": 2500}},
            "contact": {"pairs": [{"between": ["glass", p], "normal_stiffness": 100} for p in ("glass", "walls")]},
            "insertion": [{"type": "packing", "material": "glass", "diameter": 0.05, "count": 3}],
        }
        scene["interphase"] = {"voidage": "centroid"}
        text = self.check(scene)
        self.assertIn("cell size / particle", text)
        self.assertIn("note: interphase.voidage: centroid wants cells of 3 diameters", text)

    def test_conditions_and_patches_must_fit(self):
        scene = closed_box(KINDS["tetrahedra"][0], ("inlet", "outlett"))
        text = self.check(scene, EXIT_USAGE)
        for words in (
            "fluid.boundaries.outlet: missing",
            "fluid.boundaries.walls: missing",
            "fluid.boundaries.outlett: no such patch in the mesh; nearest: `outlet`",
        ):
            self.assertIn(words, text)

    def test_a_patch_needs_a_name_of_the_scene(self):
        (self.folder / "a.msh").write_text((MESHES / "tetrahedra.msh").read_text().replace('"inlet"', '"inlet 1"'))
        text = self.check(closed_box({"gmsh": {"path": "a.msh"}}, ("outlet", "walls")), EXIT_USAGE)
        self.assertIn("the patch `inlet 1` of the file cannot be named in a scene", text)

    def test_errors_name_file_and_line(self):
        bad = self.folder / "bad.msh"
        bad.write_text((MESHES / "tetrahedra.msh").read_text().replace("4.1 0 8", "2.2 0 8"))
        text = self.check(closed_box({"gmsh": {"path": "bad.msh"}}, ("walls",)), EXIT_USAGE)
        self.assertIn(f"{bad}:2: the format is 2.2", text)
        text = self.check(closed_box({"polymesh": {"path": "none"}}, ("walls",)), EXIT_USAGE)
        self.assertIn(f"fluid.mesh.polymesh.path: {self.folder}/none: no such folder", text)

    def test_a_mesh_has_one_source(self):
        scene = closed_box({"box": {"upper": [1, 1, 1], "cells": [1, 1, 1]}, "gmsh": {"path": "a.msh"}}, ("walls",))
        self.assertIn("scene.yaml:", self.check(scene, EXIT_USAGE))
        self.assertIn("fluid.mesh.box: has no meaning here", self.check(scene, EXIT_USAGE))
        del scene["fluid"]["mesh"]["box"]
        scene["fluid"]["mesh"]["periodic"] = ["x"]
        self.assertIn("fluid.mesh.periodic: has no meaning here", self.check(scene, EXIT_USAGE))

    def test_kinematic_particles_need_a_box(self):
        scene = closed_box(*KINDS["tetrahedra"])
        scene["particles"] = {
            "backend": "kinematic",
            "materials": {"glass": {"density": 2500}},
            "insertion": [{"type": "lattice", "material": "glass", "diameter": 1.0e-3}],
        }
        scene["fluid"]["mesh"] = {"gmsh": {"path": str(SOURCE / "configs/meshes/pipe.msh"), "scale": 1.0e-3}}
        scene["fluid"]["boundaries"] = {patch: {"type": "wall"} for patch in ("inlet", "outlet", "pipe")}
        _, stderr = self.run_scene(scene, expect=EXIT_USAGE)
        for words in ("particles.backend: kinematic", "is off the outer box of the mesh", "use a box mesh"):
            self.assertIn(words, stderr)


if __name__ == "__main__":
    unittest.main()
