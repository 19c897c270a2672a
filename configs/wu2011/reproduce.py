#!/usr/bin/python3
"""The experiment of Wu, Zhan, Berrouk and Nandakumar (mass conservation in DPM-CFD): runs what is missing, draws, and tells the numbers.

    reproduce.py [--twin] [--build build/release] [--out runs/wu2011] [--until 1.0] [--threads 1] [--figures DIRECTORY]
                 [--tolerances] [--choices] [--whole] [--draw]

Without --twin the bed of Table 1 (bed.yaml; a run of 1 s takes about an hour on a quiet core), with it the bed of half its size
(twin.yaml). Three methods run at once from the same settled bed: the conservative one, the legacy one, and this with the velocity of the
cells in its mass source. A run that has reached --until is not repeated; --draw runs nothing, and draws as far as the runs have come.
Figures (PNG and SVG): net_inflow, Fig. 1 of the paper; transport, a tracer that should stay 1. --tolerances runs the twin at four
tolerances of the pressure solver, --choices with what the paper leaves open chosen otherwise, both for --until or 0.1 s; with --whole
they take the bed of Table 1.

Needs Debian's python3-matplotlib, python3-numpy, python3-h5py.
"""
import argparse
import csv
import os
import subprocess
import sys
import time
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.fonttype"] = "none"  # letters stay letters
matplotlib.rcParams["svg.hashsalt"] = "wu2011"  # the same runs give the same bytes
import matplotlib.pyplot as pyplot  # noqa: E402: the backend comes first
import numpy  # noqa: E402

HERE = Path(__file__).resolve().parent
PUBLISHED = (6.0, 14.0)  # % net inflow, Fig. 1 of the paper
SURFACE = 0.7  # voidage of a layer half way from the bed to the gas above it
LEGACY = ["coupling.continuity=legacy", "coupling.audit.on_violation=warn"]
VELOCITY_OF_CELLS = ["fluid.numerics.legacy.velocity=cells"]
# By the name of the run's directory: what its curve is called, its colour, its settings.
METHODS = {
    "conservative": ("conservative", "C0", []),
    "legacy": ("legacy", "C3", LEGACY),
    "legacy_cells": ("legacy, velocity of the cells", "C1", LEGACY + VELOCITY_OF_CELLS),
}
# The bed of twin.yaml, made from settle.yaml: settled once, read by all runs.
TWIN_BED = ["fluid.mesh.box.upper=[0.125, 0.01, 0.45]", "fluid.mesh.box.cells=[25, 1, 60]", "particles.insertion[0].count=23351"]
INTERSTITIAL = [
    f"fluid.boundaries.{patch}={{type: velocity, interstitial: [0, 0, {speed}]}}" for patch, speed in (("jet", 20), ("background", 1))
]
# What the paper leaves open, each alone; the method is legacy in all of them.
CHOICES = {
    "as in twin.yaml": [],
    "velocities interstitial": INTERSTITIAL,
    "source converged to 1e-8": ["fluid.numerics.legacy={tolerance: 1e-8, iterations: 200}", "fluid.numerics.pressure_tolerance=1e-8"],
    "velocity of the cells": VELOCITY_OF_CELLS,
    "one pass of the source": ["fluid.numerics.legacy={iterations: 1}"],
    "restitution 0.6": [f"particles.contact.pairs[{pair}].restitution=0.6" for pair in (0, 1)],
    "friction 0.1": [f"particles.contact.pairs[{pair}].friction=0.1" for pair in (0, 1)],
    "stiffness 250 N/m": [f"particles.contact.pairs[{pair}].normal_stiffness=250" for pair in (0, 1)],
    "voidage by centres": ["interphase.voidage=centroid"],
    "voidage by bells of 4 d": ["interphase.voidage=kernel"],
}
TOLERANCES = ["1e-2", "1e-4", "1e-6", "1e-8"]


class Run:
    """One run of the coordinator into a directory, which may hold it already."""

    def __init__(self, options, scene, name, settings=(), until=None):
        self.directory = options.out / name
        self.until = until
        self.command = [options.build / "bin/coordinator", "run", HERE / scene, "--out", self.directory, "--quiet"]
        threads = [f"{side}.numerics.threads={options.threads}" for side in ("fluid", "particles")]
        for value in [*threads, *settings]:
            self.command += ["--set", value]
        if until is not None:
            self.command += ["--until", str(until)]
        self.process = None

    def is_done(self):
        rows = read_audit(self.directory)
        # Half a window: times are sums of windows.
        return rows is not None and rows["time"][-1] > (self.until or 0) - 0.5 * rows["time"][0]

    def start(self):
        print("running", self.directory, flush=True)
        self.process = subprocess.Popen([str(word) for word in self.command])

    def watch(self):
        """The largest memory of its processes so far [MB], written beside the audit; False once it has ended."""
        peaks = {}
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
                if int(entry.name) != self.process.pid and parent != self.process.pid:
                    continue
                status = dict(line.split(":", 1) for line in (entry / "status").read_text().splitlines())
                peaks[status["Name"].strip()] = int(status["VmHWM"].split()[0]) / 1024
            except (OSError, KeyError, IndexError):
                continue  # it has ended meanwhile
        if {"coordinator", "cfd_server", "dem_server"} <= peaks.keys() and self.directory.is_dir():
            (self.directory / "memory.csv").write_text("".join(f"{name},{peak:.0f}\n" for name, peak in peaks.items()))
        return self.process.poll() is None


def carry_out(runs):
    """All that are not done, at once; ends with the first that fails."""
    missing = [run for run in runs if not run.is_done()]
    for run in missing:
        run.start()
    try:
        while any([run.watch() for run in missing]):
            if any(run.process.poll() not in (None, 0) for run in missing):
                break
            time.sleep(1)
    finally:
        for run in missing:
            if run.process.poll() is None:
                run.process.terminate()
            run.process.wait()
    for run in missing:
        if run.process.returncode != 0:
            sys.exit(f"{run.directory}: the run ended with {run.process.returncode}; see its run.log")


def read_audit(directory):
    """Columns of audit.csv; None if it has no row yet. Of a run that goes on, the last line may be half written."""
    path = directory / "audit.csv"
    if not path.exists():
        return None
    lines = path.read_text().splitlines(keepends=True)
    header, *rows = csv.reader(line for line in lines if line.endswith("\n"))
    return dict(zip(header, numpy.array(rows, dtype=float).T)) if rows else None


def net_inflow(rows):
    """What flows in and neither out nor is stored, over what flows in [%]; nothing is stored as long as no sphere leaves."""
    return 100 * rows["relative_imbalance"]


def lost_in_cells(directory, velocity="faces"):
    """For each record of a legacy run, its step, and the gas that its equation loses in each cell over the inflow [-].

    What a cell gets, gives and stores differs by Σ_f (ε_f − ε_P)(Λ_f − ρ u_P·A_f) from what its legacy balance says: put
    Σ_f Λ_f = −(ρ/ε_P)(Δε/Δt V + Σ_f (ε_f − ε_P) u_P·A_f) into Σ_f ε_f Λ_f + ρ Δε/Δt V. It needs no more than the record: fluxes and voidage.
    `velocity` is the scene's fluid.numerics.legacy.velocity: u_P from interstitial fluxes, or from superficial ones over the cell's voidage.
    """
    rows = read_audit(directory)
    with h5py.File(directory / "results.h5", "r") as results:
        mesh = results["mesh"]
        owner, neighbour, area = mesh["owner"][:].astype(int), mesh["neighbour"][:].astype(int), mesh["face_areas"][:]
        inner = slice(0, len(neighbour))
        for record in results["fields"].values():
            step, voidage = int(record.attrs["step"]), record["voidage"][:]
            if step == 0:
                continue
            face_voidage = voidage[owner]
            face_voidage[inner] = 0.5 * (voidage[owner[inner]] + voidage[neighbour])
            superficial = record["face_flux"][:]
            interstitial = superficial / face_voidage
            # Of a cell of a lattice: the mean of its two faces along each axis.
            share = 0.5 * ((interstitial if velocity == "faces" else superficial) / (area**2).sum(axis=1))[:, None] * area
            middle = numpy.zeros((len(voidage), 3))
            numpy.add.at(middle, owner, share)
            numpy.add.at(middle, neighbour, share[inner])
            if velocity == "cells":
                middle /= voidage[:, None]
            lost = numpy.zeros(len(voidage))
            for cells, faces, sign in ((owner, slice(None), -1), (neighbour, inner, 1)):
                excess = interstitial[faces] - (middle[cells] * area[faces]).sum(axis=1)
                numpy.add.at(lost, cells, sign * (face_voidage[faces] - voidage[cells]) * excess)
            yield step, lost / rows["mass_in"][step - 1]


def thinned(values, by):
    """At most 500 values, each `by` of as many windows: the size of a figure does not grow with the run."""
    size = -(-len(values) // 500)
    return numpy.array([by(values[at : at + size]) for at in range(0, len(values), size)])


def name_curves(axis):
    """Above the axes, where no curve is hidden."""
    axis.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4, fontsize=8, frameon=False)


def draw_net_inflow(audits, title, stem):
    """Above the paper's ordinate, below that of the audit, on which the conservative method can be seen, too."""
    figure, (upper, lower) = pyplot.subplots(2, 1, figsize=(7, 5), sharex=True, height_ratios=(3, 1.4), layout="constrained")
    upper.axhspan(*PUBLISHED, color="0.92", label="published range, legacy")
    for method, rows in audits.items():
        name, colour, _ = METHODS[method]
        upper.plot(thinned(rows["time"], numpy.max), thinned(net_inflow(rows), numpy.mean), colour, lw=0.9, label=name)
        lower.semilogy(
            thinned(rows["time"], numpy.max), thinned(numpy.abs(rows["relative_imbalance"]), numpy.max), colour, lw=0.6
        )
    lower.axhline(1e-12, color="0.5", lw=0.8, ls="--")
    upper.set(ylabel="net gas inflow / inflow [%]")
    figure.suptitle(title)
    lower.set(ylabel="|imbalance|\nover inflow", xlabel="time [s]", ylim=(1e-18, 1))
    name_curves(upper)
    save(figure, stem)


def draw_transport(audits, title, stem):
    figure, axis = pyplot.subplots(figsize=(7, 3.8), layout="constrained")
    for order, (method, rows) in enumerate(audits.items()):
        name, colour, _ = METHODS[method]
        low, high = thinned(rows["scalar_uniform_min"], numpy.min), thinned(rows["scalar_uniform_max"], numpy.max)
        # The first, a line, on top of the bands.
        axis.fill_between(thinned(rows["time"], numpy.max), low, high, color=colour, lw=1.2, alpha=0.5, label=name, zorder=3 - order)
    axis.set(xlabel="time [s]", ylabel="smallest and largest value")
    figure.suptitle(f"{title}:\na tracer that is 1 at first and at the inlets")
    name_curves(axis)
    save(figure, stem)


def save(figure, stem):
    for kind in ("png", "svg"):
        figure.savefig(f"{stem}.{kind}", dpi=110, metadata={"Date": None} if kind == "svg" else None)
        print("drawn", f"{stem}.{kind}")
    pyplot.close(figure)


def tell(name, rows):
    net, after = net_inflow(rows), rows["time"] > 0.1 * rows["time"][-1]
    inside = numpy.mean((net >= PUBLISHED[0]) & (net <= PUBLISHED[1]))
    print(f"\n{name}: {len(net)} windows, {rows['time'][-1]:.4g} s")
    print(f"  net inflow / inflow       mean {net.mean():.3g} %, {net.min():.3g} to {net.max():.3g} %; {100 * inside:.0f} % of windows in 6 to 14 %")
    print(f"  after a tenth of the run  mean {net[after].mean():.3g} %, {net[after].min():.3g} to {net[after].max():.3g} %")
    print(f"  largest |imbalance|       {numpy.abs(rows['relative_imbalance']).max():.2e} of the inflow, cell {rows['max_cell_residual'].max():.2e}")
    print(f"  drift at the end          {rows['cumulative_drift'][-1]:.2e} of the gas")
    print(f"  spheres                   {rows['particle_count'][0]:.0f}, at the end {rows['particle_count'][-1]:.0f}")
    for tracer in ("uniform", "step"):
        if f"scalar_{tracer}_min" in rows:
            low, high, error = (rows[f"scalar_{tracer}_{part}"] for part in ("min", "max", "imbalance"))
            print(f"  tracer {tracer:<18} {low.min():.16g} to {high.max():.16g}; budget {numpy.abs(error).max():.1e}, in any window")


def tell_course(audits):
    """Net inflow of each tenth of a second, as rows of a table; of a run that goes on, as far as it has come."""
    legacy = {method: rows for method, rows in audits.items() if method != "conservative"}
    if not legacy:
        return
    print("\n| net inflow [%], mean and range, by | " + " | ".join(METHODS[method][0] for method in legacy) + " |")
    print("| --- |" + " --- |" * len(legacy))
    for start in numpy.arange(0, max(rows["time"][-1] for rows in legacy.values()) - 1e-9, 0.1):
        cells = []
        for rows in legacy.values():
            net = net_inflow(rows)[(rows["time"] > start + 1e-9) & (rows["time"] < start + 0.1 + 1e-9)]
            cells.append(f"{net.mean():.1f}, {net.min():.1f} to {net.max():.1f}" if len(net) else "")
        print(f"| {start:.1f} to {start + 0.1:.1f} s | " + " | ".join(cells) + " |")


def tell_places(run, rows, velocity):
    """Of each record, what the equation loses in the sum and in parts of the bed, beside the audit."""
    try:
        records = list(lost_in_cells(run.directory, velocity))
        with h5py.File(run.directory / "results.h5", "r") as results:
            height = results["mesh/cell_centres"][:, 2].round(9)
            voidage = {record.attrs["step"]: record["voidage"][:] for record in results["fields"].values()}
    except OSError as error:  # HDF5 locks the file of a run that goes on
        print(f"  where it is lost          not told: {run.directory / 'results.h5'} cannot be read ({error})")
        return
    layers = numpy.unique(height)
    print("  where it is lost: by the equation [% of the inflow], and of it the lowest four layers, between, the surface and above; the audit")
    for step, lost in records:
        means = numpy.array([voidage[step][height == layer].mean() for layer in layers])
        # A jump is felt by the cells on both sides of it.
        surface = layers[max(numpy.flatnonzero(means < SURFACE)[-1] - 1, 4)]
        parts = [height < layers[4], (height >= layers[4]) & (height < surface), height >= surface]
        shares = ", ".join(f"{100 * lost[part].sum():.2f}" for part in parts)
        print(f"    {rows['time'][step - 1]:.3f} s  {100 * lost.sum():.3f} ({shares}); {100 * rows['relative_imbalance'][step - 1]:.3f}")


def tell_cost(run, rows):
    parts = {part: rows[f"wall_{part}"] for part in ("dem", "cfd", "exchange")}
    whole = sum(parts.values())
    shares = ", ".join(f"{part} {100 * time.sum() / whole.sum():.1f} %" for part, time in parts.items())
    print(f"  wall time                 {1e3 * whole.mean():.4g} ms a window, {whole.sum() / rows['time'][-1]:.4g} s a simulated second: {shares}")
    path = run.directory / "memory.csv"
    if path.exists():
        print("  largest memory [MB]      ", ", ".join(path.read_text().split()))


def settled(options):
    bed = Run(options, "settle.yaml", "twin_settle" if options.twin else "settle", TWIN_BED if options.twin else [])
    if not options.draw and not bed.is_done():
        carry_out([bed])
    return [f"particles.insertion=[{{type: file, material: glass, path: {(bed.directory / 'results.h5').resolve()}}}]"]


def compare_methods(options):
    prefix, scene = ("twin_", "twin.yaml") if options.twin else ("", "bed.yaml")
    bed = settled(options)
    runs = {method: Run(options, scene, prefix + method, bed + settings, options.until) for method, (_, _, settings) in METHODS.items()}
    if not options.draw:
        carry_out(runs.values())
    audits = {method: rows for method, run in runs.items() if (rows := read_audit(run.directory)) is not None}
    for method in runs.keys() - audits.keys():
        print(f"{runs[method].directory}: no window yet, left out")
    if not audits:
        sys.exit("nothing to draw: run without --draw first")
    for method, rows in audits.items():
        tell(METHODS[method][0], rows)
        tell_cost(runs[method], rows)
        if method != "conservative":
            tell_places(runs[method], rows, "cells" if method == "legacy_cells" else "faces")
    tell_course(audits)
    options.figures.mkdir(parents=True, exist_ok=True)
    title = "half the bed of Wu et al., 23,351 spheres" if options.twin else "the bed of Wu et al., 186,805 spheres"
    draw_net_inflow(audits, title, options.figures / f"{prefix}net_inflow")
    draw_transport(audits, title, options.figures / f"{prefix}transport")


def compare_settings(options, kind, settings, common):
    """One run after another."""
    bed = settled(options)
    prefix, scene = ("twin_", "twin.yaml") if options.twin else ("", "bed.yaml")
    for index, (name, values) in enumerate(settings.items()):
        run = Run(options, scene, f"{prefix}{kind}_{index}", bed + common + values, options.until or 0.1)
        if not options.draw:
            carry_out([run])
        rows = read_audit(run.directory)
        if rows is not None:
            tell(name, rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--twin", action="store_true", help="the bed of half the size")
    parser.add_argument("--build", type=Path, default=HERE.parents[1] / "build/release", help="folder of the build")
    parser.add_argument("--out", type=Path, default=Path("runs/wu2011"), help="folder of the runs")
    parser.add_argument("--until", type=float, help="end of the runs [s]")
    parser.add_argument("--threads", type=int, default=1, help="of each server")
    parser.add_argument("--figures", type=Path, help="where the figures go (default: --out)")
    parser.add_argument("--tolerances", action="store_true", help="the twin, conservative, at four tolerances of the pressure solver")
    parser.add_argument("--choices", action="store_true", help="the twin, legacy, with what the paper leaves open chosen otherwise")
    parser.add_argument("--whole", action="store_true", help="with --tolerances or --choices: the bed of Table 1, not the twin")
    parser.add_argument("--draw", action="store_true", help="run nothing")
    options = parser.parse_args()
    options.figures = options.figures or options.out
    options.twin = options.twin or ((options.tolerances or options.choices) and not options.whole)
    if options.whole and not (options.tolerances or options.choices):
        parser.error("--whole goes with --tolerances or --choices; the bed of Table 1 is run without --twin anyway")
    if not options.draw and not os.access(options.build / "bin/coordinator", os.X_OK):
        parser.error(f"{options.build}/bin/coordinator is not there; build it, or name its folder with --build")
    if options.tolerances:
        compare_settings(options, "tolerance", {f"pressure to {t}": [f"fluid.numerics.pressure_tolerance={t}"] for t in TOLERANCES}, [])
    if options.choices:
        compare_settings(options, "choice", CHOICES, LEGACY)
    if not (options.tolerances or options.choices):
        options.until = options.until or 1.0
        compare_methods(options)


if __name__ == "__main__":
    main()
