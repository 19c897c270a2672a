#!/usr/bin/env python3
"""The native particle engine beside LAMMPS and LIGGGHTS: the same bed, law, steps and core.

    compare_dem.py --bench build/tests/dem_bench --bed FILE.h5|CSV [--fluidised] [--mixed] [--rounds 3]
                   [--steps 480] [--core 0] [--lock FILE] [--keep DIRECTORY]

Spheres of 2 mm (2250 kg/m3) in 0.25 x 0.02 x 0.6 m, linear springs and dashpots with friction (k_n 1000 N/m, k_t 2/7 k_n, e 0.9, mu 0.3), five
plane walls, gravity, 5 us. Each engine runs 20 steps that are not timed, then `--steps`; the engines take turns, one core each. First all
must tell of the same bed: mean height, top and kinetic energy at the end. Engines that are not installed (Debian: lammps, liggghts) are
left out, and said so. Of the others' loop times, the share is taken for which they had the core: measure on a quiet machine.
"""
import argparse
import csv
import fcntl
import math
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

DIAMETER, DENSITY, STIFFNESS, RESTITUTION, FRICTION = 2e-3, 2250.0, 1000.0, 0.9, 0.3
TANGENTIAL = 2.0 / 7.0 * STIFFNESS
BOX = (0.25, 0.02, 0.6)
NUMBER = r"([-+0-9.eE]+)"

LAMMPS = """units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
processors * 1 1
read_data {data}
pair_style gran/hooke/history {kn} {kt} {gn} {gt} {mu} 1
pair_coeff * *
neighbor 0.0003 bin
neigh_modify delay 0 every 1 check yes
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
fix wb all wall/gran hooke/history {kn} {kt} {gnw} {gtw} {mu} 1 zplane 0.0 NULL
fix wy all wall/gran hooke/history {kn} {kt} {gnw} {gtw} {mu} 1 yplane 0.0 {y}
fix wx all wall/gran hooke/history {kn} {kt} {gnw} {gtw} {mu} 1 xplane 0.0 {x}
timestep 5e-6
thermo 1000
compute zc all reduce ave z
variable zm equal bound(all,zmax)
thermo_style custom step ke v_zm c_zc
thermo_modify norm no flush yes lost error format float %.12g
run 20 post no
run {steps} pre no
"""

LIGGGHTS = """atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
processors * 1 1
read_data {data}
neighbor 0.0003 bin
neigh_modify delay 0 every 1 check yes
fix m1 all property/global kn peratomtypepair 2 {kn} {kn} {kn} {kn}
fix m2 all property/global kt peratomtypepair 2 {kt} {kt} {kt} {kt}
fix m3 all property/global gamman peratomtypepair 2 {gn} {gnw} {gnw} {gnw}
fix m4 all property/global gammat peratomtypepair 2 {gt} {gtw} {gtw} {gtw}
fix m5 all property/global coefficientFriction peratomtypepair 2 {mu} {mu} {mu} {mu}
pair_style gran model hooke/stiffness tangential history
pair_coeff * *
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
fix wb all wall/gran model hooke/stiffness tangential history primitive type 2 zplane 0.0
fix wy1 all wall/gran model hooke/stiffness tangential history primitive type 2 yplane 0.0
fix wy2 all wall/gran model hooke/stiffness tangential history primitive type 2 yplane {y}
fix wx1 all wall/gran model hooke/stiffness tangential history primitive type 2 xplane 0.0
fix wx2 all wall/gran model hooke/stiffness tangential history primitive type 2 xplane {x}
timestep 5e-6
thermo 1000
compute zc all reduce ave z
variable zm equal bound(all,zmax)
thermo_style custom step ke v_zm c_zc
thermo_modify norm no flush yes lost error format float %.12g
run 20 post no
run {steps} pre no
"""


def law(steps, data):
    """Parameters of the scripts; the dashpots from the restitution as docs/theory.md has them."""
    mass = math.pi / 6 * DIAMETER**3 * DENSITY
    log_e = math.log(RESTITUTION)

    def damping(effective_mass):
        return 2 * math.sqrt(STIFFNESS / effective_mass) * -log_e / math.hypot(math.pi, log_e)

    return {
        "kn": STIFFNESS, "kt": repr(TANGENTIAL), "mu": FRICTION, "x": BOX[0], "y": BOX[1], "steps": steps, "data": data,
        "gn": repr(damping(mass / 2)), "gt": repr(damping(mass / 2) / 2), "gnw": repr(damping(mass)), "gtw": repr(damping(mass) / 2),
    }  # fmt: skip


def write_data(rows, path, types):
    """The bed as LAMMPS and LIGGGHTS read it. The box is the bed's, its top left open."""
    with open(path, "w") as file:
        file.write(f"bed\n\n{len(rows)} atoms\n{types} atom types\n\n0 {BOX[0]} xlo xhi\n0 {BOX[1]} ylo yhi\n0 {BOX[2]} zlo zhi\n\nAtoms\n\n")
        for i, row in enumerate(rows, 1):
            file.write(f"{i} 1 {row['diameter']} {DENSITY} {row['x']} {row['y']} {row['z']}\n")
        file.write("\nVelocities\n\n")
        for i, row in enumerate(rows, 1):
            file.write(f"{i} {row['vx']} {row['vy']} {row['vz']} 0 0 0\n")


def run(command, args):
    """What the program wrote, and the share of its time for which it had the core."""
    with open(args.lock or os.devnull, "a") as lock:
        if args.lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        done = subprocess.run(["taskset", "-c", str(args.core)] + command, capture_output=True, text=True)
        after, elapsed = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - start
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: ended with {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done.stdout, min(1.0, spent / elapsed)


def run_native(bed, precision, args):
    text, _ = run([args.bench, "--bed", str(bed), "--repeats", "1", "--steps", str(args.steps), "--precision", precision], args)
    columns = [part.split() for part in text.splitlines()[-2].split("|")]
    rate, processor, steps_a_list = float(columns[1][0]), float(columns[2][0]), float(columns[4][0])
    state = re.search(f"mean height {NUMBER} m, top {NUMBER} m, kinetic energy {NUMBER} J", text)
    height, top, energy = map(float, state.groups())
    return {"rate": rate, "processor": processor, "height": height, "top": top, "energy": energy, "rebuilds": round((args.steps + 20) / steps_a_list), "text": text.splitlines()[-1].strip()}


def run_other(command, script, count, args):
    text, share = run(command + ["-in", str(script), "-log", "none"], args)
    loops = re.findall(rf"Loop time of {NUMBER} on 1 procs for (\d+) steps", text)
    rows = re.findall(rf"^\s*{args.steps + 20}\s+{NUMBER}\s+{NUMBER}\s+{NUMBER}\s*$", text, re.M)
    if len(loops) != 2 or not rows:
        sys.exit(f"{command[0]}: no loop times or no row of step {args.steps + 20} in\n{text[-3000:]}")
    energy, top, height = map(float, rows[-1])
    rebuilds = re.findall(r"Neighbor list builds = (\d+)", text)
    rate = 1e-6 * count * int(loops[1][1]) / float(loops[1][0])
    state = {"height": height, "top": top, "energy": energy}
    return {"rate": rate, "processor": rate / share, "rebuilds": rebuilds[-1] if rebuilds else "", **state}


def check_same_bed(results, fluidised):
    """Chaos sets the tolerances: a bed at rest follows the same path for 500 steps, one in motion only in its sums. LIGGGHTS limits
    friction by the spring alone and shortens the lever arm, so its kinetic energy may differ by some per cent; so may that of a bed at rest
    in mixed precision, which is what slips before all springs hold."""
    ours = results["native"][0]
    for name, of in results.items():
        energy_tolerance = 0.05 if name in ("LIGGGHTS", "mixed") else (1e-3 if fluidised else 5e-3)
        height_tolerance = 1e-6 if name in ("LIGGGHTS", "mixed") else 1e-7
        for key, tolerance in (("height", height_tolerance), ("top", 1e-4), ("energy", energy_tolerance)):
            apart = abs(of[0][key] / ours[key] - 1)
            print(f"  {name:9} {key:7} {of[0][key]:.12g}  {apart:.1e} from native, allowed {tolerance:.0e}")
            if apart > tolerance:
                sys.exit(f"{name} does not follow the same bed: {key} differs by {apart:.2e}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", required=True, help="the program dem_bench")
    parser.add_argument("--bed", required=True, help="HDF5 or CSV")
    parser.add_argument("--fluidised", action="store_true", help="the bed in motion: about one new list in 50 steps")
    parser.add_argument("--mixed", action="store_true", help="the native engine in mixed precision, too")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--steps", type=int, default=480, help="timed, after 20 that are not; a multiple of 20")
    parser.add_argument("--core", type=int, default=0)
    parser.add_argument("--lock", help="file to lock during each run, where others share the machine")
    parser.add_argument("--keep", help="directory for bed and scripts; default: one that is removed")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(args.keep or scratch)
        folder.mkdir(exist_ok=True)
        bed = folder / "bed.csv"
        start = ["--fluidised"] if args.fluidised else []
        subprocess.run([args.bench, "--bed", args.bed, *start, "--write", bed], check=True, stdout=subprocess.DEVNULL)
        with open(bed) as file:
            rows = list(csv.DictReader(file))
        engines = {"native": lambda: run_native(bed, "double", args)}
        if args.mixed:
            engines["mixed"] = lambda: run_native(bed, "mixed", args)
        for name, program, text, types in (("LAMMPS", "lmp", LAMMPS, 1), ("LIGGGHTS", "liggghts", LIGGGHTS, 2)):
            if shutil.which(program) is None:
                print(f"{name}: `{program}` is not installed, left out")
                continue
            write_data(rows, folder / f"{program}.data", types)
            (folder / f"{program}.in").write_text(text.format(**law(args.steps, folder / f"{program}.data")))
            engines[name] = lambda program=program: run_other([program], folder / f"{program}.in", len(rows), args)
        results = {name: [] for name in engines}
        for turn in range(args.rounds):
            for name, engine in engines.items():
                results[name].append(engine())
                print(f"round {turn + 1}: {name:9} {results[name][-1]['processor']:.2f} M particle-steps/s", flush=True)
            if turn == 0:
                check_same_bed(results, args.fluidised)
    print(f"\n{len(rows)} particles, {'in motion' if args.fluidised else 'at rest'}, {args.steps} steps, {results['native'][0]['text']}")
    print("| engine | M particle-steps a second of processor time, median (all) | of wall time | native is faster by | new lists |")
    print("| --- | --- | --- | --- | --- |")
    for name, of in results.items():
        every = " ".join(f"{r['processor']:.2f}" for r in of)
        middle = statistics.median(r["processor"] for r in of)
        wall = statistics.median(r["rate"] for r in of)
        paired = statistics.median(a["processor"] / b["processor"] for a, b in zip(results["native"], of))
        print(f"| {name} | {middle:.2f} ({every}) | {wall:.2f} | {paired:.2f} | {of[0]['rebuilds']} |")


if __name__ == "__main__":
    main()
