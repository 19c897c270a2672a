"""Drag laws in whole runs: beds that must carry their weight, spheres that must settle as the law says, laws of the user's own."""

import math
import unittest

import numpy

from programs import EXIT_NUMERICS, EXIT_USAGE, ProgramTest, small_bed

WEN_YU = "3*pi*viscosity*diameter * (1 + 0.15*reynolds^0.687) * voidage^-2.65"


def ergun(voidage, superficial, density, viscosity, diameter):
    """Pressure gradient of a packed bed [Pa/m]."""
    solids = 1 - voidage
    return (
        150 * solids**2 * viscosity * superficial / (voidage**3 * diameter**2)
        + 1.75 * solids * density * superficial**2 / (voidage**3 * diameter)
    )


class Fluidisation(ProgramTest):
    """A settled bed of 400 spheres of 1 mm under a gas whose velocity goes up through that of minimum fluidisation, down, and stays."""

    DIAMETER, DENSITY, VISCOSITY, SOLID, GRAVITY = 1e-3, 10.0, 1.5e-3, 2000.0, 9.81
    SIDE, LAYER, LAYERS, COUNT = 5e-3, 3e-3, 13, 400
    FLOOR = 2  # layers of gas below the bed
    LOW, HIGH, LAST = 0.004, 0.020, 0.006
    UP, DOWN, END = 0.4, 0.8, 0.95

    def superficial(self, time):
        if time <= self.UP:
            return self.LOW + (self.HIGH - self.LOW) * time / self.UP
        return self.HIGH + (self.LAST - self.HIGH) * min((time - self.UP) / (self.DOWN - self.UP), 1)

    def scene(self, model, end):
        table = [[time, self.superficial(time)] for time in (0, self.UP, self.DOWN, self.END)]
        floor = self.FLOOR * self.LAYER
        return {
            "version": 1,
            "scene": {"name": f"ramp-{model}", "gravity": [0, 0, -self.GRAVITY], "end_time": end},
            "coupling": {"window": 1.0e-3},
            "fluid": {
                "density": self.DENSITY,
                "viscosity": self.VISCOSITY,
                "mesh": {
                    "box": {"upper": [self.SIDE, self.SIDE, self.LAYERS * self.LAYER], "cells": [1, 1, self.LAYERS]},
                    "periodic": ["x", "y"],
                    "patches": {"inlet": {"side": "z_min"}, "outlet": {"side": "z_max"}},
                },
                "boundaries": {
                    "inlet": {"type": "velocity", "superficial": [0, 0, 1], "profile": [{"along": "time", "points": table}]},
                    "outlet": {"type": "pressure"},
                },
                "initial": {"superficial": [0, 0, self.LOW]},
                "numerics": {"pressure_tolerance": 1e-10, "threads": 1},
            },
            "particles": {
                "time_step": 1.25e-5,
                "numerics": {"threads": 1},
                "materials": {"glass": {"density": self.SOLID}},
                "contact": {
                    "pairs": [
                        {"between": ["glass", "glass"], "normal_stiffness": 200, "restitution": 0.3, "friction": 0.3},
                        {"between": ["glass", "walls"], "normal_stiffness": 200, "restitution": 0.3, "friction": 0.3},
                    ]
                },
                "surfaces": {"floor": {"type": "plane", "point": [0, 0, floor], "normal": [0, 0, 1]}},
                "insertion": [
                    {"type": "settled", "material": "glass", "diameter": self.DIAMETER, "count": self.COUNT, "within": {"z": [floor, floor + 0.02]}}
                ],
            },
            "interphase": {"drag": "gidaspow", "model": model},
            "output": {"fields": {"every": 0.01}, "particles": {"every": 1.0}},
        }

    def gradient(self, voidage, superficial):
        return ergun(voidage, superficial, self.DENSITY, self.VISCOSITY, self.DIAMETER)

    def minimum_fluidisation(self, layers, weight):
        """Superficial velocity at which Ergun's equation, summed over the layers of the bed, bears the weight: a U + b U²."""
        one, two = (sum(self.gradient(e, u) for e in layers if e < 0.8) * self.LAYER for u in (1, 2))
        b = (two - 2 * one) / 2
        a = one - b
        return (-a + math.sqrt(a * a + 4 * b * weight)) / (2 * b)

    def ramp(self, model, end):
        """Of each record: time, superficial velocity, whole pressure drop, that inside the bed over Ergun's. And the voidages at time 0."""
        out = self.folder / model
        self.run_scene(self.scene(model, end), out=out, timeout=500)
        rows = []
        for record in sorted(self.results(out)["fields"].values(), key=lambda each: each.attrs["time"]):
            time = record.attrs["time"]
            pressure, voidage = record["pressure"][:], record["voidage"][:]
            if time == 0:
                start = voidage
                continue  # no fluid step yet
            # From the centre of the bed's first layer to that of its third: full layers, none of which holds the bed's top.
            first, second, third = (self.gradient(e, self.superficial(time)) for e in voidage[self.FLOOR : self.FLOOR + 3])
            law = (first / 2 + second + third / 2) * self.LAYER
            inside = pressure[self.FLOOR] - pressure[self.FLOOR + 2]
            rows.append((time, self.superficial(time), pressure[0] - pressure[-1], inside / law))
        return numpy.array(rows), start

    def check_rise(self, rows, start, weight):
        """The branch of the fixed bed, the plateau, and the break between them on the way up. Slope of the first, height of the second."""
        time, superficial, drop, inside = rows[rows[:, 0] <= self.UP].T
        expected = self.minimum_fluidisation(start, weight)
        fixed = (superficial > 0.4 * expected) & (superficial < 0.8 * expected)
        floating = superficial > 1.1 * expected
        # While the gas gets faster, by 0.4 to 0.8 % a window, drag on spheres that rest on others lags by about as much.
        self.assertAlmostEqual(inside[fixed].mean(), 1, delta=0.01)
        self.assertLess(numpy.abs(inside[fixed] - 1).max(), 0.03)
        self.assertAlmostEqual(drop[floating].mean() / weight, 1, delta=0.01)
        self.assertLess(numpy.abs(drop[floating] / weight - 1).max(), 0.03)
        line = numpy.polyfit(superficial[fixed], drop[fixed], 1)
        plateau = drop[floating].mean()
        self.assertAlmostEqual((plateau - line[1]) / line[0] / expected, 1, delta=0.03)
        return numpy.polyval(line, 0.6 * expected), plateau

    def test_bed_is_fixed_then_floats_then_is_fixed_again(self):
        weight = self.COUNT * math.pi / 6 * self.DIAMETER**3 * (self.SOLID - self.DENSITY) * self.GRAVITY / self.SIDE**2
        rows, start = self.ramp("a", self.END)
        fixed, plateau = self.check_rise(rows, start, weight)
        time, superficial, drop, inside = rows.T
        # Down: while the gas slows down by 0.035 m/s² the bed sinks ever faster, by some twice that: up to 0.7 % of its weight.
        floating = (time > self.UP) & (superficial > 1.2 * self.minimum_fluidisation(start, weight))
        self.assertAlmostEqual(drop[floating].mean() / weight, 1, delta=0.01)
        # In steady flow the bed has come to rest: the law holds.
        self.assertAlmostEqual(inside[-1], 1, delta=0.002)
        # Model b is the same bed, but for the layer that holds its top, where the voidage of a sphere is a mean of two cells.
        rows, start = self.ramp("b", self.UP)
        fixed_b, plateau_b = self.check_rise(rows, start, weight)
        self.assertAlmostEqual(fixed_b / fixed, 1, delta=0.005)
        self.assertAlmostEqual(plateau_b / plateau, 1, delta=0.005)


def settling_scene(box, cells, periodic, density, viscosity, solid, drag, window, end):
    """Spheres that sink in a fluid at rest, open at the top."""
    return {
        "version": 1,
        "scene": {"name": "settling", "gravity": [0, 0, -9.81], "end_time": end},
        "coupling": {"window": window},
        "fluid": {
            "density": density,
            "viscosity": viscosity,
            "mesh": {"box": {"upper": box, "cells": cells}, "periodic": periodic, "patches": {"top": {"side": "z_max"}}},
            "boundaries": {"top": {"type": "pressure"}, "walls": {"type": "wall"}},
            "numerics": {"pressure_tolerance": 1e-10, "threads": 1},
        },
        "particles": {
            "time_step": window / 4,
            "numerics": {"threads": 1},
            "materials": {"glass": {"density": solid}},
            "contact": {
                "pairs": [
                    {"between": ["glass", "glass"], "normal_stiffness": 1e-3},
                    {"between": ["glass", "walls"], "normal_stiffness": 1e-3},
                ]
            },
            "outflow": [],
        },
        "interphase": {"drag": drag},
        "output": {"fields": {"every": end}, "particles": {"every": end}},
    }


class Settling(ProgramTest):
    def last(self, path=None):
        particles = self.results(path)["particles"]
        return max(particles.values(), key=lambda each: each.attrs["time"])

    def test_one_sphere_reaches_its_terminal_velocity(self):
        # Cells of 100 diameters: the fluid that the sphere drags along in one of them is too slow to be seen.
        diameter, density, viscosity, solid = 1e-4, 10, 1e-4, 3000
        scene = settling_scene([0.06, 0.06, 0.06], [6, 6, 6], [], density, viscosity, solid, "schiller_naumann", 1e-3, 0.2)
        path = self.folder / "sphere.csv"
        path.write_text("x,y,z\n0.025,0.025,0.05\n")
        scene["particles"]["insertion"] = [{"type": "file", "material": "glass", "diameter": diameter, "path": str(path)}]
        self.run_scene(scene)
        weight = (solid - density) * math.pi / 6 * diameter**3 * 9.81
        slow, fast = 0.0, 1.0
        for _ in range(60):
            middle = (slow + fast) / 2
            reynolds = density * middle * diameter / viscosity
            drag = 3 * math.pi * viscosity * diameter * middle * (1 + 0.15 * reynolds**0.687)
            slow, fast = (middle, fast) if drag < weight else (slow, middle)
        self.assertAlmostEqual(slow, 0.13734, delta=1e-5)
        self.assertAlmostEqual(-self.last()["velocity"][0, 2] / slow, 1, delta=0.005)

    def test_a_uniform_suspension_is_hindered_as_richardson_and_zaki_found(self):
        # In creeping flow a suspension sinks at the speed of one sphere times ε^4.65; that is also what the law of Wen and Yu implies:
        # ζ ~ ε^−2.65, slip ε V_p Δρ g/ζ, and the speed is ε times the slip where as much fluid comes up as solids go down.
        diameter, density, viscosity, solid = 2e-4, 1000, 0.01, 2500
        voidages = [0.6, 0.75, 0.9]
        speeds = []
        for voidage in voidages:
            # A lattice with three spheres to each edge of a cell. Its nine columns stand at nine heights, so that at any time as much
            # leaves a cell as comes in, and the voidage stays uniform.
            spacing = diameter * (math.pi / 6 / (1 - voidage)) ** (1 / 3)
            cell, layers = 3 * spacing, 8
            box = [cell, cell, layers * cell]
            scene = settling_scene(box, [1, 1, layers], ["x", "y"], density, viscosity, solid, "wen_yu", 2e-4, 0.02)
            places = [
                (i + 0.5, j + 0.5, k + 0.55 + (3 * i + j) / 9) for k in range(3 * (layers - 1)) for j in range(3) for i in range(3)
            ]
            path = self.folder / "lattice.csv"
            path.write_text("x,y,z\n" + "".join(",".join(repr(x * spacing) for x in place) + "\n" for place in places))
            scene["particles"]["insertion"] = [{"type": "file", "material": "glass", "diameter": diameter, "path": str(path)}]
            out = self.folder / f"out-{voidage}"
            self.run_scene(scene, out=out)
            record = self.last(out)
            height = record["position"][:, 2]
            inside = (height > 2 * cell) & (height < 5 * cell)
            speeds.append(-record["velocity"][:][inside, 2].mean())
        terminal = (solid - density) * 9.81 * diameter**2 / (18 * viscosity)
        for voidage, speed in zip(voidages, speeds):
            # 1.6 % of it is the 0.15 Re^0.687 at Re = 0.04.
            self.assertAlmostEqual(speed / (terminal * voidage**4.65), 1, delta=0.03)
        exponent = numpy.polyfit(numpy.log(voidages), numpy.log(speeds), 1)[0]
        self.assertAlmostEqual(exponent / 4.65, 1, delta=0.02)


class OwnLaw(ProgramTest):
    """interphase.drag: expression."""

    def bed(self, drag, **own):
        scene = small_bed()
        scene["interphase"] = {"drag": drag, **({"drag_expression": own} if own else {})}
        return scene

    def test_gives_what_the_built_in_law_gives(self):
        # The same spheres in the same jet for 40 windows: round-off has no time to grow.
        drops = []
        for name, scene in (("own", self.bed("expression", coefficient=WEN_YU)), ("built-in", self.bed("wen_yu"))):
            out = self.folder / name
            self.run_scene(scene, out=out)
            fields = self.results(out)["fields"]
            drops.append(fields[max(fields, key=int)]["pressure"][:])
        self.assertLess(numpy.abs(drops[0] - drops[1]).max(), 1e-6 * numpy.abs(drops[1]).max())

    def test_is_refused_before_the_run_at_its_place(self):
        _, error = self.run_scene(self.bed("expression", coefficient="viscosity*diameter + slip"), expect=EXIT_USAGE)
        self.assertIn("interphase.drag_expression.coefficient: formula 'viscosity*diameter + slip': `+` between kg/s and m/s", error)
        self.assertIn("(character 20)", error)

    def test_that_turns_negative_stops_the_run_and_names_the_particle(self):
        # Positive where the check tried it, but the gas is faster.
        scene = self.bed("expression", coefficient="viscosity*diameter*(1 - reynolds/100)", slip=[0, 0.5])
        _, error = self.run_scene(scene, expect=EXIT_NUMERICS)
        self.assertRegex(error, r"drag coefficient of particle \d+ at \(.*\) m is -\S+ kg/s at voidage")

    def test_has_no_range_but_a_built_in_law_tells_when_it_is_left(self):
        stdout, _ = self.run_scene(self.bed("stokes"))
        self.assertEqual(self.log().count("drag law stokes is known to hold for voidage 0.95 .. 1"), 1)
        self.assertIn("of the particles beyond its range", stdout)
        stdout, _ = self.run_scene(self.bed("expression", coefficient=WEN_YU), out=self.folder / "own")
        self.assertNotIn("beyond its range", stdout)


if __name__ == "__main__":
    unittest.main()
