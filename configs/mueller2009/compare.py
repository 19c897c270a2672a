#!/usr/bin/python3
"""Judge a run of bed.yaml by the points that Mueller et al. measured.

    configs/mueller2009/compare.py RUN... [--start 2] [--end 12] [--figures DIRECTORY]

The measurement is a mean over time and over the depth of the bed. Of a run, or of several with other packings together, from `start` to
`end`:
voidage    that of the recorded cells, mean over the depth, linear between the centres of cells;
cut        voidage again, from the spheres alone: the part of a horizontal plane that they do not cover, in strips of 2 mm;
velocity   mean over the particles within 1 mm of the height, in strips of 2 mm: each particle counts once in each record, as each seed
           gives its signal to the magnetic resonance.
Printed are the root mean squares of the differences at the measured points, with a standard error from ten equal blocks of time, and of
velocities the share of the measured circulation: the factor by which the measured points come nearest to the run's; 0 of a bed at rest,
below 0 of one that circulates the other way round.
"""

import argparse
import contextlib
import pathlib
import sys

import h5py
import numpy

HERE = pathlib.Path(__file__).resolve().parent
VOIDAGE_HEIGHTS = (16.4, 31.2)  # [mm]
VELOCITY_HEIGHTS = (15, 25, 35)  # [mm]
STRIP = 2e-3  # [m] width of the strips of x
SLAB = 1e-3  # [m] half the thickness of the slab of velocities
BLOCKS = 10


def measured(quantity, height):
    """Measured points: x [m], and voidage or vertical velocity of the particles [m/s]."""
    name = f"{quantity}_{height:g}mm".replace(".", "_")
    table = numpy.loadtxt(HERE / f"{name}.csv", delimiter=",", skiprows=1)
    return table[:, 0] * 1e-3, table[:, 1]


def records(group, start, end):
    """Records of a group within the span, once each: the last one of a run may stand there twice."""
    found = {}
    for record in group.values():
        if start < record.attrs["time"] <= end:
            found[record.attrs["step"]] = record
    return [found[step] for step in sorted(found)]


def voidage_of_cells(results, height, start, end):
    """x [m] of the columns of cells, and for each record the voidage there."""
    centres = results["mesh/cell_centres"][:].round(9)
    columns, layers = numpy.unique(centres[:, 0]), numpy.unique(centres[:, 2])
    above = numpy.searchsorted(layers, height)
    share = (height - layers[above - 1]) / (layers[above] - layers[above - 1])
    rows = []
    for record in records(results["fields"], start, end):
        voidage = record["voidage"][:]
        values = [
            [voidage[(centres[:, 0] == x) & (centres[:, 2] == layers[layer])].mean() for x in columns] for layer in (above - 1, above)
        ]
        rows.append((1 - share) * numpy.array(values[0]) + share * numpy.array(values[1]))
    return columns, numpy.array(rows)


def strips(results):
    """Edges [m] of the strips of x, and the depth of the bed [m]."""
    points = results["mesh/points"][:]
    width, depth = numpy.ptp(points[:, 0]), numpy.ptp(points[:, 1])
    return numpy.linspace(0, width, round(width / STRIP) + 1), depth


def voidage_of_cut(results, height, start, end):
    """Centres of the strips [m], and for each record 1 - covered area over the strip's."""
    edges, depth = strips(results)
    rows = []
    for record in records(results["particles"], start, end):
        position, radius = record["position"][:], record["radius"][:]
        cut = numpy.abs(position[:, 2] - height) < radius
        disc = numpy.sqrt(radius[cut] ** 2 - (position[cut, 2] - height) ** 2)
        reach = numpy.clip((edges - position[cut, 0, None]) / disc[:, None], -1, 1)
        left = disc[:, None] ** 2 * (reach * numpy.sqrt(1 - reach**2) + numpy.arcsin(reach) + numpy.pi / 2)
        rows.append(1 - numpy.diff(left.sum(axis=0)) / (numpy.diff(edges) * depth))
    return (edges[1:] + edges[:-1]) / 2, numpy.array(rows)


def velocity_of_particles(results, height, start, end):
    """Centres of the strips [m], and for each record the sum of the vertical velocities there [m/s] and the number of particles."""
    edges, _ = strips(results)
    sums, counts = [], []
    for record in records(results["particles"], start, end):
        position = record["position"][:]
        near = numpy.abs(position[:, 2] - height) < SLAB
        x = position[near, 0]
        sums.append(numpy.histogram(x, edges, weights=record["velocity"][:][near, 2])[0])
        counts.append(numpy.histogram(x, edges)[0])
    return (edges[1:] + edges[:-1]) / 2, numpy.array(sums), numpy.array(counts)


class Curve:
    """A mean over time beside the measured points: rms difference, share, and standard errors from blocks of time."""

    def __init__(self, quantity, height, x, sums, counts):
        self.quantity, self.height, self.x = quantity, height, x
        self.points = measured("velocity" if quantity == "velocity" else "voidage", height)
        blocks = numpy.array_split(numpy.arange(len(sums)), BLOCKS)
        self.mean = self.mean_of(sums, counts)
        values = numpy.array([self.mean_of(sums[block], counts[block]) for block in blocks])
        self.error = values.std(axis=0, ddof=1) / numpy.sqrt(BLOCKS)
        self.rms, self.share = self.rms_of(self.mean), self.share_of(self.mean)
        without = [numpy.delete(numpy.arange(len(sums)), block) for block in blocks]
        means = [self.mean_of(sums[rest], counts[rest]) for rest in without]
        self.rms_error, self.share_error = self.jackknife(self.rms_of, means), self.jackknife(self.share_of, means)

    @staticmethod
    def mean_of(sums, counts):
        count = counts.sum(axis=0)
        return numpy.where(count > 0, sums.sum(axis=0) / numpy.maximum(count, 1), 0)

    @staticmethod
    def jackknife(number_of, means):
        values = numpy.array([number_of(mean) for mean in means])
        return numpy.sqrt((BLOCKS - 1) / BLOCKS * ((values - values.mean()) ** 2).sum())

    def rms_of(self, mean):
        x, values = self.points
        return numpy.sqrt(numpy.mean((numpy.interp(x, self.x, mean) - values) ** 2))

    def share_of(self, mean):
        x, values = self.points
        return numpy.dot(numpy.interp(x, self.x, mean), values) / numpy.dot(values, values)


def curves(runs, start, end):
    """All that is compared, by name and height; `runs`: the results of one or more."""
    found = []
    for height in VOIDAGE_HEIGHTS:
        for quantity, source in (("voidage", voidage_of_cells), ("cut", voidage_of_cut)):
            parts = [source(results, height * 1e-3, start, end) for results in runs]
            rows = numpy.concatenate([rows for _, rows in parts])
            found.append(Curve(quantity, height, parts[0][0], rows, numpy.ones_like(rows)))
    for height in VELOCITY_HEIGHTS:
        parts = [velocity_of_particles(results, height * 1e-3, start, end) for results in runs]
        sums, counts = (numpy.concatenate([part[column] for part in parts]) for column in (1, 2))
        found.append(Curve("velocity", height, parts[0][0], sums, counts))
    return found


def report(found):
    """Lines to print."""
    lines = ["quantity   height [mm]   rms difference            middle of the bed: run, measured"]
    for curve in found:
        middle = 0.022
        there = numpy.interp(middle, curve.x, curve.mean), numpy.interp(middle, *curve.points)
        share = f"   {curve.share:.2f} +- {curve.share_error:.2f} of the circulation" if curve.quantity == "velocity" else ""
        lines.append(f"{curve.quantity:10} {curve.height:11g}   {curve.rms:.4f} +- {curve.rms_error:.4f}          {there[0]:.3f}, {there[1]:.3f}{share}")
    return lines


def draw(found, quantity, others, label, path):
    import matplotlib  # only figures need it

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "mueller2009"
    from matplotlib import pyplot

    chosen = [curve for curve in found if curve.quantity == quantity]
    figure, axes = pyplot.subplots(1, len(chosen), figsize=(4 * len(chosen), 3.2), sharey=True, squeeze=False)
    for axis, curve in zip(axes[0], chosen):
        axis.plot(curve.points[0] * 1e3, curve.points[1], "ko", markersize=3.5, label="measured (Mueller et al.)")
        axis.errorbar(curve.x * 1e3, curve.mean, 2 * curve.error, capsize=2, linewidth=1.5, label="fluxpact, ± 2 standard errors")
        for other in found:
            if other.quantity == others and other.height == curve.height:
                axis.plot(other.x * 1e3, other.mean, "--", linewidth=1, label="fluxpact, plane through the spheres")
        axis.set_title(f"{curve.height:g} mm above the frit", fontsize=9)
        axis.set_xlabel("x [mm]")
        axis.grid(alpha=0.3)
    axes[0][0].set_ylabel(label)
    axes[0][0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path.with_suffix(".png"), dpi=110, metadata={"Software": None})
    figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", metavar="RUN", type=pathlib.Path, nargs="+", help="folder of the results")
    parser.add_argument("--start", type=float, default=2, help="begin of the mean [s]")
    parser.add_argument("--end", type=float, default=numpy.inf, help="its end [s]")
    parser.add_argument("--figures", type=pathlib.Path, help="folder for voidage and velocity, .png and .svg")
    options = parser.parse_args()
    with contextlib.ExitStack() as opened:
        runs = [opened.enter_context(h5py.File(run / "results.h5", "r")) for run in options.runs]
        for run, results in zip(options.runs, runs):
            last = max(record.attrs["time"] for record in results["particles"].values())
            if last < options.start + 0.1:
                sys.exit(f"{run}: ends at {last:g} s, before there is anything to average from {options.start:g} s")
            print(f"{run}: mean from {options.start:g} to {min(last, options.end):g} s")
        found = curves(runs, options.start, options.end)
    print("\n".join(report(found)))
    if options.figures:
        options.figures.mkdir(parents=True, exist_ok=True)
        draw(found, "voidage", "cut", "voidage", options.figures / "voidage")
        draw(found, "velocity", None, "vertical velocity of particles [m/s]", options.figures / "velocity")


if __name__ == "__main__":
    main()
