#!/usr/bin/python3
"""The experiment of Wu, Zhan, Berrouk and Nandakumar (mass conservation in DPM-CFD): runs what is missing, draws, and tells the numbers.

    reproduce.py [--twin] [--build build/release] [--out runs/wu2011] [--until 1.0] [--threads 1] [--figures DIRECTORY]
                 [--tolerances] [--choices] [--whole] [--tracers] [--records] [--draw]

Without --twin the bed of Table 1 (bed.yaml; a run of 1 s takes about an hour on a quiet core), with it the bed of half its size
(twin.yaml). The conservative and the legacy method run at once from the same settled bed. A run that has reached --until is not
repeated; --draw runs nothing, and draws as far as the runs have come. Figures (PNG and SVG): net_inflow, Fig. 1 of the paper; with
--twin transport, a tracer that should stay 1. --tolerances runs the twin at four tolerances of the pressure solver, --choices
with what the paper leaves open chosen otherwise, both for --until or 0.1 s; with --whole they take the bed of Table 1. --tracers adds to
that bed the tracers of the twin. --records starts that bed from each record of its legacy run, with the velocity of the cells in the mass
source.

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
LEGACY = ["coupling.continuity=legacy", "coupling.audit.on_violation=warn"]
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
    "velocity of the cells": ["fluid.numerics.legacy.velocity=cells"],
    "one pass of the source": ["fluid.numerics.legacy={iterations: 1}"],
    "restitution 0.6": [f"particles.contact.pairs[{pair}].restitution=0.6" for pair in (0, 1)],
    "friction 0.1": [f"particles.contact.pairs[{pair}].friction=0.1" for pair in (0, 1)],
    "stiffness 250 N/m": [f"particles.contact.pairs[{pair}].normal_stiffness=250" for pair in (0, 1)],
    "voidage by centres": ["interphase.voidage=centroid"],
    "voidage by bells of 4 d": ["interphase.voidage=kernel"],
}
# The tracers of twin.yaml, in the bed of Table 1.
INLETS = "jet: {value: 1}, background: {value: 1}"
TRACERS = [
    f"fluid.scalars.uniform={{diffusivity: 2.0e-5, initial: 1, boundaries: {{{INLETS}, outlet: {{value: 1}}}}}}",
    f"fluid.scalars.step={{diffusivity: 2.0e-5, boundaries: {{{INLETS}, outlet: {{value: 0}}}}}}",
]
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


def lost_in_cells(directory):
    """For each record of a legacy run, its time, and the gas that its equation loses in each cell over the inflow [-].

    What a cell gets, gives and stores differs by Σ_f (ε_f − ε_P)(Λ_f − ρ u_P·A_f) from what its legacy balance says: put
    Σ_f Λ_f = −(ρ/ε_P)(Δε/Δt V + Σ_f (ε_f − ε_P) u_P·A_f) into Σ_f ε_f Λ_f + ρ Δε/Δt V. It needs no more than the record: fluxes and voidage.
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
            interstitial = record["face_flux"][:] / face_voidage
            # Of a cell of a lattice: the mean of its two faces along each axis.
            share = 0.5 * (interstitial / (area**2).sum(axis=1))[:, None] * area
            velocity = numpy.zeros((len(voidage), 3))
            numpy.add.at(velocity, owner, share)
            numpy.add.at(velocity, neighbour, share[inner])
            lost = numpy.zeros(len(voidage))
            for cells, faces, sign in ((owner, slice(None), -1), (neighbour, inner, 1)):
                excess = interstitial[faces] - (velocity[cells] * area[faces]).sum(axis=1)
                numpy.add.at(lost, cells, sign * (face_voidage[faces] - voidage[cells]) * excess)
            yield step, lost / rows["mass_in"][step - 1]


def thinned(values, by):
    """At most 500 values, each `by` of as many windows: the size of a figure does not grow with the run."""
    size = -(-len(values) // 500)
    return numpy.array([by(values[at : at + size]) for at in range(0, len(values), size)])


def draw_net_inflow(audits, title, stem):
    """Above the paper's ordinate, below that of the audit, on which the conservative method can be seen, too."""
    figure, (upper, lower) = pyplot.subplots(2, 1, figsize=(7, 5), sharex=True, height_ratios=(3, 1.4), layout="constrained")
    upper.axhspan(*PUBLISHED, color="0.92", label="published range, legacy")
    for (name, rows), colour in zip(audits.items(), ("C0", "C3")):
        upper.plot(thinned(rows["time"], numpy.max), thinned(net_inflow(rows), numpy.mean), colour, lw=0.9, label=name)
        lower.semilogy(
            thinned(rows["time"], numpy.max), thinned(numpy.abs(rows["relative_imbalance"]), numpy.max), colour, lw=0.6
        )
    lower.axhline(1e-12, color="0.5", lw=0.8, ls="--")
    upper.set(ylabel="net gas inflow / inflow [%]", title=title)
    lower.set(ylabel="|imbalance|\nover inflow", xlabel="time [s]", ylim=(1e-18, 1))
    upper.legend(loc="upper right", fontsize=8)
    save(figure, stem)


def draw_transport(audits, stem):
    figure, axis = pyplot.subplots(figsize=(7, 3.2), layout="constrained")
    for (name, rows), colour in zip(audits.items(), ("C0", "C3")):
        low, high = thinned(rows["scalar_uniform_min"], numpy.min), thinned(rows["scalar_uniform_max"], numpy.max)
        axis.fill_between(thinned(rows["time"], numpy.max), low, high, color=colour, lw=1.2, alpha=0.5, label=name)
    axis.set(xlabel="time [s]", ylabel="smallest and largest value", title="A tracer that is 1 everywhere at the start and at the inlets")
    axis.legend(fontsize=8)
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
    for tracer in ("uniform", "step"):
        if f"scalar_{tracer}_min" in rows:
            low, high, error = (rows[f"scalar_{tracer}_{part}"] for part in ("min", "max", "imbalance"))
            print(f"  tracer {tracer:<18} {low.min():.16g} to {high.max():.16g}; budget {numpy.abs(error).max():.1e}, in any window")


def tell_places(run, rows):
    print("  where it is lost: by the equation, beside the audit [% of the inflow]")
    for step, lost in lost_in_cells(run.directory):
        gained = 100 * lost[lost < 0].sum()
        print(f"    {rows['time'][step - 1]:.3f} s  {100 * lost.sum():.3f} beside {100 * rows['relative_imbalance'][step - 1]:.3f} (cells lose "
              f"{100 * lost.sum() - gained:.1f}, and make {-gained:.1f})")


def tell_cost(name, run, rows):
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
    prefix, scene = ("twin_", "twin.yaml") if options.twin else ("tracer_" if options.tracers else "", "bed.yaml")
    bed = settled(options) + (TRACERS if options.tracers else [])
    runs = {
        "conservative": Run(options, scene, prefix + "conservative", bed, options.until),
        "legacy": Run(options, scene, prefix + "legacy", bed + LEGACY, options.until),
    }
    if not options.draw:
        carry_out(runs.values())
    audits = {name: read_audit(run.directory) for name, run in runs.items()}
    for name, rows in audits.items():
        if rows is None:
            sys.exit(f"{runs[name].directory}: no window yet")
        tell(name, rows)
        tell_cost(name, runs[name], rows)
    if (runs["legacy"].directory / "results.h5").exists() and not options.draw:
        tell_places(runs["legacy"], audits["legacy"])
    options.figures.mkdir(parents=True, exist_ok=True)
    title = "half the bed of Wu et al., 23,351 spheres" if options.twin else "the bed of Wu et al., 186,805 spheres"
    draw_net_inflow(audits, title, options.figures / f"{prefix}net_inflow")
    if options.twin or options.tracers:
        draw_transport(audits, options.figures / f"{prefix}transport")


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


def sample_records(options):
    """Some windows from the spheres of each record of the legacy run, which have the velocity of the cells in the mass source."""
    path = options.out / "legacy/results.h5"
    if not path.exists():
        sys.exit(f"{path}: not there; run the bed without --records first")
    with h5py.File(path, "r") as results:
        times = {name: record.attrs["time"] for name, record in results["particles"].items()}
    for name, start in times.items():
        insertion = [f"particles.insertion=[{{type: file, material: glass, path: {path.resolve()}, group: /particles/{name}}}]"]
        values = insertion + LEGACY + CHOICES["velocity of the cells"]
        run = Run(options, "bed.yaml", f"record_{name}", values, options.until or 0.003)
        if start > 0 and not options.draw:
            carry_out([run])
        rows = read_audit(run.directory)
        if rows is not None:
            tell(f"from {start:g} s", rows)


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
    parser.add_argument("--tracers", action="store_true", help="the bed of Table 1 with the tracers of the twin")
    parser.add_argument("--records", action="store_true", help="from each record of the legacy run, the velocity of the cells in the source")
    parser.add_argument("--draw", action="store_true", help="run nothing")
    options = parser.parse_args()
    options.figures = options.figures or options.out
    options.twin = options.twin or ((options.tolerances or options.choices) and not options.whole)
    if options.twin and (options.tracers or options.records):
        parser.error("--tracers and --records are of the bed of Table 1: the twin has its tracers, leave --twin out")
    if options.whole and not (options.tolerances or options.choices):
        parser.error("--whole goes with --tolerances or --choices; the bed of Table 1 is run without --twin anyway")
    if not options.draw and not os.access(options.build / "bin/coordinator", os.X_OK):
        parser.error(f"{options.build}/bin/coordinator is not there; build it, or name its folder with --build")
    if options.tolerances:
        compare_settings(options, "tolerance", {f"pressure to {t}": [f"fluid.numerics.pressure_tolerance={t}"] for t in TOLERANCES}, [])
    if options.choices:
        compare_settings(options, "choice", CHOICES, LEGACY)
    if options.records:
        sample_records(options)
    if not (options.tolerances or options.choices or options.records):
        options.until = options.until or 1.0
        compare_methods(options)


if __name__ == "__main__":
    main()
