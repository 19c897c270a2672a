"""States that the whole chain must hold exactly: a uniform bed in steady flow, a bed at rest in still fluid."""

import math
import unittest

import numpy

from programs import ProgramTest, small_bed


def porous_column(superficial, voidage, diameter):
    return {
        "version": 1,
        "scene": {"name": "porous-column", "gravity": [0, 0, -9.81], "end_time": 0.2},
        "coupling": {"window": 1.0e-3},
        "fluid": {
            "density": 1.2,
            "viscosity": 1.8e-5,
            "mesh": {
                "box": {"upper": [0.02, 0.02, 0.1], "cells": [2, 2, 10]},
                "patches": {"inlet": {"side": "z_min"}, "outlet": {"side": "z_max"}},
            },
            "boundaries": {
                "inlet": {"type": "velocity", "superficial": [0, 0, superficial]},
                "outlet": {"type": "pressure", "value": 0},
                "walls": {"type": "wall", "slip": "free"},
            },
            "initial": {"superficial": [0, 0, superficial]},
            "numerics": {"pressure_tolerance": 1e-13},
        },
        "interphase": {"voidage": "prescribed", "prescribed": {"voidage": str(voidage), "diameter": diameter}},
    }


class UniformBed(ProgramTest):
    def test_has_the_pressure_gradient_of_the_drag_law(self):
        superficial, voidage, diameter, density, viscosity = 0.8, 0.42, 2e-3, 1.2, 1.8e-5
        self.run_scene(porous_column(superficial, voidage, diameter))
        solids = 1 - voidage
        ergun = (
            150 * solids**2 * viscosity * superficial / (voidage**3 * diameter**2)
            + 1.75 * solids * density * superficial**2 / (voidage**3 * diameter)
        )
        fields = self.results()["fields"]
        pressure = fields[max(fields, key=int)]["pressure"][:].reshape(10, 4).mean(axis=1)
        gradients = numpy.diff(pressure) / 0.01
        # 1e-10: the tolerance of the pressure solver, 1e-13, times the ten cells of the column and then some.
        self.assertLess(numpy.abs(gradients / -ergun - 1).max(), 1e-10)


class AtRest(ProgramTest):
    def still(self, scene):
        for name in ("jet", "background"):
            scene["fluid"]["boundaries"][name] = {"type": "wall"}
        scene["scene"]["end_time"] = 0.1
        return scene

    def largest(self, path):
        return max(numpy.abs(record[path][:]).max() for record in self.results()["fields"].values())

    def test_frozen_spheres_leave_the_fluid_at_rest(self):
        scene = self.still(small_bed())
        scene["particles"]["backend"] = "kinematic"
        scene["particles"]["insertion"] = [{"type": "lattice", "material": "glass", "diameter": 2e-3, "within": {"z": [0, 0.02]}}]
        self.run_scene(scene)
        self.assertLess(self.largest("velocity"), 1e-13)
        for record in self.results()["fields"].values():
            self.assertLess(numpy.ptp(record["pressure"][:]), 1e-12)  # of 0.7 Pa: without its hydrostatic part it is uniform

    def test_spheres_on_the_floor_stay_there(self):
        scene = self.still(small_bed())
        radius, density, stiffness, gravity, air = 1e-3, 2250, 300, 9.81, 1.225
        volume = 4 / 3 * math.pi * radius**3
        height = radius - (density - air) * volume * gravity / stiffness  # weight less buoyancy, on the spring of the wall
        rows = [f"{0.003 + 0.004 * i},{0.003 + 0.004 * j},{height!r}" for i in range(4) for j in range(2)]
        path = self.folder / "particles.csv"
        path.write_text("x,y,z\n" + "\n".join(rows) + "\n")
        scene["particles"]["insertion"] = [{"type": "file", "material": "glass", "diameter": 2 * radius, "path": str(path)}]
        self.run_scene(scene)
        particles = self.results()["particles"]
        last = particles[max(particles, key=int)]
        # Round-off of the spring's force (1e-16 m of 1 mm times 300 N/m on 9.4 mg) is 3e-9 m/s² · 2e-5 s a sub-step: 1e-13 m/s
        # a kick; the damped spring adds no more than a few of them up.
        self.assertLess(numpy.abs(last["velocity"][:]).max(), 1e-11)
        self.assertLess(numpy.abs(last["position"][:, 2] - height).max(), 1e-14)
        self.assertLess(self.largest("velocity"), 1e-11)


if __name__ == "__main__":
    unittest.main()
