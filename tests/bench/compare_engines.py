#!/usr/bin/env python3
"""One scene on every particle engine: the same bed, what it costs, and what stays the same.

    compare_engines.py --build BUILD [--scene configs/engines.yaml] [--engines native lammps ...] [--out DIRECTORY] [--check]

Each engine runs the whole scene, one after the other. The table has, of the settled bed, its height (twice the mean height of the centres), and
as means over the time from `--from` on, the pressure drop over the weight per area and the bed's height; over the second half of that, the
root of the mean square of the spheres' speed; then the largest relative imbalance of mass, the time on the wall in all and of the particle
side, and the largest memory of the particle server with its children, five times a second.
--check: exit code 1 unless any two engines with springs agree: settled height 1 %, pressure drop 2 %, height 5 %, all conserve mass to 1e-12, and
in none the spheres lie still.
"""
import argparse
import csv
import itertools
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

ALL = ["native", "lammps", "liggghts", "yade", "hard_sphere"]
LIMITS = {"settled": 0.01, "drop": 0.02, "height": 0.05}
IMBALANCE = 1e-12
STILL = 0.01  # m/s: slower is no bubbling bed, whatever its means


def children_of(parent):
    """Ids of all processes below `parent`, by /proc."""
    parents = {}
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", encoding="utf-8", errors="replace") as stat:
                parents[int(entry)] = int(stat.read().rpartition(")")[2].split()[1])
        except OSError:
            continue  # it has just ended
    found, last = set(), {parent}
    while last:
        last = {child for child, above in parents.items() if above in last}
        found |= last
    return found


def memory_of(process):
    """Bytes: its resident pages, each shared one by halves, thirds, ... between those that share it."""
    try:
        with open(f"/proc/{process}/smaps_rollup", encoding="utf-8") as rollup:
            for line in rollup:
                if line.startswith("Pss:"):
                    return 1024 * int(line.split()[1])
    except OSError:
        pass  # it has just ended
    return 0


def is_fluid(process):
    try:
        return os.path.basename(os.readlink(f"/proc/{process}/exe")) == "cfd_server"
    except OSError:
        return True


def run(build, scene, engine, out, overrides):
    """Runs the scene; returns seconds and bytes."""
    command = [build / "bin/coordinator", "run", scene, "--out", out, "--quiet", "--set", f"particles.backend={engine}"]
    for one in overrides:
        command += ["--set", one]
    began, memory = time.monotonic(), 0
    out.parent.mkdir(parents=True, exist_ok=True)
    with open(out.parent / f"{engine}.log", "w", encoding="utf-8") as log:
        with subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT) as process:
            while process.poll() is None:
                now = sum(memory_of(child) for child in children_of(process.pid) if not is_fluid(child))
                memory = max(memory, now)
                time.sleep(0.2)
    if process.returncode != 0:
        sys.exit(f"{engine}: exit code {process.returncode}; see {out.parent / (engine + '.log')}")
    return time.monotonic() - began, memory


def measure(out, begin):
    """What the run tells: settled height [m], drop over weight per area [-], height [m], rms speed in the second half [m/s], imbalance [-],
    particle side [s]."""
    with h5py.File(out / "results.h5") as results:
        particles = results["particles"]
        records = sorted(particles, key=int)
        times = numpy.array([particles[record].attrs["time"] for record in records])
        heights = numpy.array([2 * particles[record]["position"][:, 2].mean() for record in records])
        squares = numpy.array([(particles[record]["velocity"][:] ** 2).sum(axis=1).mean() for record in records])
        first = particles[records[0]]
        mass = float((numpy.pi / 6 * (2 * first["radius"][:]) ** 3 * first["density"][:]).sum())
        points = results["mesh/points"][:]
        extent = points.max(axis=0) - points.min(axis=0)
        layers = len(numpy.unique(numpy.round(points[:, 2] / extent[2], 9))) - 1
        drops = []
        for record in sorted(results["fields"], key=int):
            layer = results["fields"][record]["pressure"][:].reshape(layers, -1).mean(axis=1)
            drops.append((results["fields"][record].attrs["time"], 1.5 * layer[0] - 0.5 * layer[1]))  # at the bottom
    drops = numpy.array(drops)
    with open(out / "audit.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    weight = mass * 9.81 / (extent[0] * extent[1])
    return {
        "settled": heights[numpy.argmin(abs(times - 0.4))],
        "drop": drops[drops[:, 0] >= begin, 1].mean() / weight,
        "height": heights[times >= begin].mean(),
        "speed": numpy.sqrt(squares[times >= 0.5 * (begin + times[-1])].mean()),
        "imbalance": max(abs(float(row["relative_imbalance"])) for row in rows),
        "particles": sum(float(row["wall_dem"]) for row in rows),
    }


def table(results):
    lines = ["| engine | settled height [mm] | pressure drop / weight | bed height [mm] | rms speed [m/s] | imbalance | wall [s] | particles [s] | memory [MB] |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for engine, one in results.items():
        lines.append(f"| {engine} | {1e3 * one['settled']:.2f} | {one['drop']:.4f} | {1e3 * one['height']:.1f} | {one['speed']:.3f} | {one['imbalance']:.1e} | "
                     f"{one['wall']:.1f} | {one['particles']:.1f} | {one['memory'] / 2**20:.0f} |")
    return "\n".join(lines)


def disagreements(results):
    found = [f"{engine}: imbalance {one['imbalance']:.2e} > {IMBALANCE}" for engine, one in results.items() if one["imbalance"] > IMBALANCE]
    found += [f"{engine}: the bed lies still, {one['speed']:.2g} m/s" for engine, one in results.items() if one["speed"] < STILL]
    springs = {engine: one for engine, one in results.items() if engine != "hard_sphere"}  # which has no resting contact
    for name, limit in LIMITS.items():
        for (engine, one), (other, its) in itertools.combinations(springs.items(), 2):
            off = one[name] / its[name] - 1
            if abs(off) > limit:
                found.append(f"{engine}: {name} {one[name]:.5g} is {100 * off:+.2f} % off that of {other}, limit {100 * limit:g} %")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    source = pathlib.Path(__file__).resolve().parents[2]
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--scene", type=pathlib.Path, default=source / "configs/engines.yaml")
    parser.add_argument("--engines", nargs="+", default=ALL, choices=ALL)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--from", dest="begin", type=float, default=0.6, help="s: means are taken from here on")
    parser.add_argument("--set", dest="overrides", action="append", default=[])
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.out or pathlib.Path(scratch)
        results = {}
        for engine in options.engines:
            seconds, memory = run(options.build, options.scene, engine, folder / engine, options.overrides)
            results[engine] = measure(folder / engine, options.begin) | {"wall": seconds, "memory": memory}
            print(f"{engine}: done in {seconds:.0f} s", file=sys.stderr, flush=True)
    print(table(results))
    if options.check:
        wrong = disagreements(results)
        print("\n".join(wrong))
        sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
