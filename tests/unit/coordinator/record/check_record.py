"""Reads a results directory without any code of the project, and checks that its files agree.

Usage: check_record.py DIRECTORY CELLS FACES. Prints what is wrong and exits with 1, or prints a summary.
"""
import csv
import pathlib
import sys
import xml.etree.ElementTree as xml

import h5py
import numpy

directory = pathlib.Path(sys.argv[1])
cells, faces = int(sys.argv[2]), int(sys.argv[3])
file = h5py.File(directory / "results.h5", "r")


def check(condition, *message):
    if not condition:
        print(*message)
        sys.exit(1)


def check_units(name, item):
    if isinstance(item, h5py.Dataset):
        check(isinstance(item.attrs.get("units"), str) and item.attrs["units"], name, "has no units")


def check_attributes():
    check(file.attrs["format_version"] == 1, "format_version", file.attrs["format_version"])
    check(file.attrs["program"] == "fluxpact", "program", file.attrs["program"])
    check(file.attrs["continuity"] in ("conservative", "legacy"), file.attrs["continuity"])
    file.visititems(check_units)


def check_mesh():
    mesh = file["mesh"]
    check(mesh["owner"].shape == (faces,), "owner", mesh["owner"].shape)
    check(mesh["cell_volumes"].shape == (cells,), "cell_volumes", mesh["cell_volumes"].shape)
    check(mesh["face_offsets"][-1] == len(mesh["face_points"]), "face_offsets")
    first, size = mesh["patches/first"][:], mesh["patches/size"][:]
    check(first[0] == len(mesh["neighbour"]) and first[-1] + size[-1] == faces, "patches", first, size)
    # Every cell is closed: the area vectors of its faces cancel.
    areas, internal = mesh["face_areas"][:], len(mesh["neighbour"])
    closed = numpy.zeros((cells, 3))
    numpy.add.at(closed, mesh["owner"][:], areas)
    numpy.subtract.at(closed, mesh["neighbour"][:], areas[:internal])
    check(abs(closed).max() < 1e-14 * abs(areas).max() * 10, "cells are not closed", closed)


def check_audit():
    with open(directory / "audit.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    check(len(rows) > 0, "audit.csv has no row")
    wall = {"wall_cfd", "wall_dem", "wall_exchange"}
    check(set(file["audit"]) == set(rows[0]) - wall, "columns of /audit:", sorted(file["audit"]))
    for name, column in file["audit"].items():
        kind = int if column.dtype.kind == "i" else float
        expected = numpy.array([kind(row[name]) for row in rows])
        check(numpy.array_equal(column[:], expected, equal_nan=kind is float), name, "differs from audit.csv")
    return len(rows)


def scalars():
    """Datasets of the run's scalars: each has a column of its amount."""
    end = "_amount"
    return {name[: -len(end)] for name in file["audit"] if name.startswith("scalar_") and name.endswith(end)}


def check_records():
    for kind in ("fields", "particles"):
        for index, (name, group) in enumerate(file.get(kind, {}).items()):
            check(int(name) == index, kind, name)
            check(group.attrs["time"] >= 0 and group.attrs["step"] >= 0, kind, name, "has no time")
    for group in file.get("fields", {}).values():
        expected = {"voidage": (cells,), "velocity": (cells, 3), "pressure": (cells,),
                    "drag_coefficient": (cells,), "particle_velocity": (cells, 3), "face_flux": (faces,)}
        expected.update({name: (cells,) for name in scalars()})
        check({key: item.shape for key, item in group.items()} == expected, group.name, list(group.items()))
    for group in file.get("particles", {}).values():
        check(set(group) == {"id", "position", "velocity", "spin", "radius", "density"}, list(group))
        check((numpy.diff(group["id"][:]) > 0).all(), group.name, "is not ordered by id")


def box_cells():
    return tuple(len(file["mesh/lattice_" + axis]) - 1 for axis in "zyx")


def check_item(item):
    check({"Format", "NumberType", "Precision", "Dimensions"} <= set(item.attrib), item.attrib)
    check(item.get("Format") == "HDF", item.get("Format"))
    name, path = item.text.split(":")
    check(name == "results.h5" and path in file, "names what is not there:", item.text)
    dataset = file[path]
    kind = {"Float": "f", "Int": "i"}[item.get("NumberType")]
    check(dataset.dtype.kind == kind, path, "is of type", dataset.dtype)
    check(dataset.dtype.itemsize == int(item.get("Precision")), path, "is of type", dataset.dtype)
    shape = tuple(int(extent) for extent in item.get("Dimensions").split())
    if len(shape) >= 3:  # a field of a box grid: flat in the file, by planes and lines in the index
        components = shape[3:]
        check(shape[:3] == box_cells(), path, "is drawn as", shape)
        shape = (cells,) + components
    check(dataset.shape == shape, path, "has shape", dataset.shape, "not", shape)


def check_xdmf():
    """The index names what is there, with the times of the records and all fields of the cells."""
    root = xml.parse(directory / "results.xdmf").getroot()
    for item in root.iter("DataItem"):
        check_item(item)
    collections = {grid.get("Name"): grid for grid in root.find("Domain")}
    for collection in collections.values():
        check(collection.get("CollectionType") == "Temporal", collection.attrib)
    times = [float(grid.find("Time").get("Value")) for grid in collections["fluid"]]
    check(times == [group.attrs["time"] for group in file["fields"].values()], "times", times)
    for grid in collections["fluid"]:
        names = {item.get("Name") for item in grid.findall("Attribute")}
        check(names == set(file["fields/000000"]) - {"face_flux"}, "cell fields", names)
        topology = grid.find("Topology")
        if topology.get("TopologyType") == "3DRectMesh":
            nodes = [int(count) for count in topology.get("Dimensions").split()]
            check(tuple(count - 1 for count in nodes) == box_cells(), "topology", nodes)
            lines = [int(item.get("Dimensions")) for item in grid.find("Geometry")]
            check(lines == nodes[::-1], "nodes", lines)
    particles = [group for group in file.get("particles", {}).values() if len(group["id"])]
    drawn = list(collections.get("particles", []))
    check(len(drawn) == len(particles), "times of particles", len(drawn))
    for grid, group in zip(drawn, particles):
        check(int(grid.find("Topology").get("NumberOfElements")) == len(group["id"]), group.name)
        check(float(grid.find("Time").get("Value")) == group.attrs["time"], group.name)
    return len(times), len(particles)


check_attributes()
check_mesh()
rows = check_audit()
check_records()
print("rows", rows, "fields and particles", *check_xdmf())
