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


def ergun(voidage, superficial, diameter, density, viscosity):
    solids = 1 - voidage
    return (
        150 * solids**2 * viscosity * superficial / (voidage**3 * diameter**2)
        + 1.75 * solids * density * superficial**2 / (voidage**3 * diameter)
    )


def beetstra(voidage, superficial, diameter, density, viscosity):
    """Beetstra, van der Hoef and Kuipers 2007: force on a sphere less that of the pressure gradient, 3 π μ d U F."""
    solids = 1 - voidage
    reynolds = density * superficial * diameter / viscosity
    factor = 10 * solids / voidage**2 + voidage**2 * (1 + 1.5 * math.sqrt(solids))
    factor += (
        0.413 * reynolds / (24 * voidage**2) * (1 / voidage + 3 * voidage * solids + 8.4 * reynolds**-0.343)
        / (1 + 10 ** (3 * solids) * reynolds ** (-(1 + 4 * solids) / 2))
    )
    return 18 * viscosity * solids * superficial * factor / diameter**2 / voidage


class UniformBed(ProgramTest):
    def check(self, expected, **interphase):
        superficial, voidage, diameter = 0.8, 0.42, 2e-3
        scene = porous_column(superficial, voidage, diameter)
        scene["interphase"].update(interphase)
        out = self.folder / "-".join(str(each) for each in interphase.values() if isinstance(each, str))
        self.run_scene(scene, out=out)
        fields = self.results(out)["fields"]
        pressure = fields[max(fields, key=int)]["pressure"][:].reshape(10, 4).mean(axis=1)
        gradients = numpy.diff(pressure) / 0.01
        # 1e-10: the tolerance of the pressure solver, 1e-13, times the ten cells of the column and then some.
        law = expected(voidage, superficial, diameter, 1.2, 1.8e-5)
        self.assertLess(numpy.abs(gradients / -law - 1).max(), 1e-10, interphase)

    def test_has_the_pressure_gradient_of_the_drag_law_in_both_models(self):
        for model in "ab":
            self.check(ergun, drag="gidaspow", model=model)
            self.check(beetstra, drag="beetstra", model=model)

    def test_has_the_pressure_gradient_of_a_law_of_the_users_own(self):
        # Ergun's equation as momentum exchange per volume of bed, its second part by named constants.
        own = {
            "coefficient": "150*(1-voidage)^2*viscosity/(voidage*diameter^2) + slow*k*(1-voidage)*density*slip/(fast*diameter)",
            "constants": {"slow": {"value": 3.5, "unit": "m/s"}, "fast": {"value": 2, "unit": "m/s"}, "k": {"value": 1}},
        }
        self.check(ergun, drag="expression", drag_expression=own)


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
