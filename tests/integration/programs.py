"""Start the real programs on small scenes: shared by the integration tests."""

import csv
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

import h5py
import numpy
import yaml

BIN = pathlib.Path(os.environ["FLUXPACT_BIN"])
SOURCE = pathlib.Path(os.environ["FLUXPACT_SOURCE"])
COORDINATOR = BIN / "coordinator"

EXIT_DONE, EXIT_USAGE, EXIT_CONSERVATION, EXIT_PARTICIPANT, EXIT_NUMERICS, EXIT_INTERRUPTED = 0, 2, 3, 4, 5, 130


def small_bed():
    """A bubbling bed of 300 particles that runs in about a second."""
    return {
        "version": 1,
        "scene": {"name": "small-bed", "gravity": [0, 0, -9.81], "end_time": 0.02},
        "coupling": {"window": 5.0e-4},
        "fluid": {
            "density": 1.225,
            "viscosity": 1.8e-5,
            "mesh": {
                "box": {"lower": [0, 0, 0], "upper": [0.02, 0.01, 0.06], "cells": [4, 2, 12]},
                "patches": {
                    "jet": {"side": "z_min", "within": {"x": [0.005, 0.015]}},
                    "background": {"side": "z_min"},
                    "outlet": {"side": "z_max"},
                },
            },
            "boundaries": {
                "jet": {"type": "velocity", "superficial": [0, 0, 3.0]},
                "background": {"type": "velocity", "superficial": [0, 0, 1.0]},
                "outlet": {"type": "pressure", "value": 0},
                "walls": {"type": "wall"},
            },
        },
        "particles": {
            "time_step": 2.0e-5,
            "materials": {"glass": {"density": 2250}},
            "contact": {
                "pairs": [
                    {"between": ["glass", "glass"], "normal_stiffness": 300},
                    {"between": ["glass", "walls"], "normal_stiffness": 300},
                ]
            },
            "insertion": [
                {"type": "packing", "material": "glass", "diameter": 2.0e-3, "count": 300, "within": {"z": [0, 0.02]}, "seed": 1}
            ],
        },
        "output": {"fields": {"every": 0.005}, "particles": {"every": 0.01}},
    }


def blown_through(scene):
    """The same with gas that rises from the start on: the particles feel it in the first window."""
    scene["fluid"]["initial"] = {"superficial": [0, 0, 1.0]}
    return scene


def legacy(scene):
    scene["coupling"]["continuity"] = "legacy"
    return scene


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own; whatever it starts is ended with it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "out"

    def write_scene(self, scene, name="scene.yaml"):
        path = self.folder / name
        path.write_text(scene if isinstance(scene, str) else yaml.safe_dump(scene, sort_keys=False))
        return path

    def start(self, scene, *arguments, out=None, environment=None):
        command = [COORDINATOR, "run", self.write_scene(scene), "--out", out or self.out, *arguments]
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, **(environment or {})}
        )
        self.addCleanup(self.end, process)
        return process

    def participant(self, *command):
        """A server or a participant of our own, started by hand."""
        process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, process)
        return process

    def end(self, process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def run_scene(self, scene, *arguments, expect=EXIT_DONE, out=None, environment=None, timeout=120):
        process = self.start(scene, *arguments, out=out, environment=environment)
        stdout, stderr = process.communicate(timeout=timeout)
        self.assertEqual(process.returncode, expect, f"{stdout}\n{stderr}\n{self.log(out)}")
        return stdout, stderr

    def log(self, out=None):
        path = (out or self.out) / "run.log"
        return path.read_text() if path.exists() else ""

    def audit(self, out=None):
        return read_audit(out or self.out)

    def results(self, out=None):
        file = h5py.File((out or self.out) / "results.h5", "r")
        self.addCleanup(file.close)
        return file

    def wait_for_windows(self, process, count, timeout=60):
        """Wait until audit.csv has this many rows; the run must still be going."""
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            self.assertIsNone(process.poll(), "the run ended early")
            path = self.out / "audit.csv"
            if path.exists() and path.read_text().count("\n") > count:
                return
            time.sleep(0.01)
        self.fail(f"no {count} windows within {timeout} s")


def read_audit(directory):
    """audit.csv as a list of rows of numbers."""
    with open(directory / "audit.csv", newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def column_vectors(rows, name):
    """name_x, name_y, name_z of the rows of an audit; one row a window."""
    return numpy.array([[row[f"{name}_{axis}"] for axis in "xyz"] for row in rows])


def handovers(rows):
    """[N s] What the fluid handed over in each window but the last, and what the particles were given in the one after it. What they are
    given in the first window is lent: the fluid loses it in the same window, beside what it hands over."""
    lost = -column_vectors(rows, "momentum_to_fluid")
    given = column_vectors(rows, "momentum_to_particles")
    lost[0] -= given[0]
    return lost[:-1], given[1:]


def children(process, name):
    """Process ids of the running children of this name."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)
            if fields[0].split("(", 1)[1] == name and int(fields[1].split()[1]) == process.pid:
                found.append(int(entry.name))
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found


def is_alive(pid):
    try:
        state = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"


def kill(pid, number=signal.SIGKILL):
    os.kill(pid, number)
