"""A particle participant written from docs/protocol.md alone: a frozen porous block, in another language than the project's.

It shows that the protocol is complete: nothing here is shared with the C++ code.
"""

import struct
import sys

import msgpack
import numpy
import yaml
import zmq

PROTOCOL_VERSION = 1


class Participant:
    def __init__(self, endpoint, voidage, drag, offers=False):
        self.socket = zmq.Context.instance().socket(zmq.DEALER)
        self.socket.linger = 0
        self.socket.connect(endpoint)
        self.session, self.sequence, self.received = "", 0, 0
        self.voidage, self.drag = voidage, drag
        self.step, self.attempt = 0, 0
        self.offers = offers  # can take part in coupling.scheme parallel
        self.log = []

    def say(self, kind, body=None, arrays=None):
        arrays = {name: numpy.ascontiguousarray(array, dtype="<f8") for name, array in (arrays or {}).items()}
        header = {
            "version": PROTOCOL_VERSION,
            "type": kind,
            "session": self.session,
            "sequence": self.sequence,
            "step": self.step,
            "attempt": self.attempt,
            "body": body or {},
            "arrays": [{"name": name, "dtype": "f64", "shape": list(array.shape)} for name, array in arrays.items()],
        }
        self.sequence += 1
        self.socket.send_multipart([msgpack.packb(header)] + [array.tobytes() for array in arrays.values()])

    def hear(self):
        if not self.socket.poll(30_000):
            raise TimeoutError("the coordinator is silent")
        frames = self.socket.recv_multipart()
        header = msgpack.unpackb(frames[0])
        assert header["sequence"] == self.received
        self.received += 1
        arrays = {}
        for info, frame in zip(header["arrays"], frames[1:]):
            arrays[info["name"]] = numpy.frombuffer(frame, dtype={"f64": "<f8", "i32": "<i4"}[info["dtype"]]).reshape(info["shape"])
        return header, arrays

    def serve(self):
        self.say(
            "hello",
            {
                "role": "particles",
                "name": "porous block",
                "backend": "kinematic",
                "program": "python",
                "pid": 0,
                "gives": ["voidage", "drag_coefficient", "drag_source", "impulse_given", "particle_velocity"],
                "needs": ["velocity", "pressure_gradient"],
                **({"offers": 1} if self.offers else {}),
            },
        )
        while True:
            header, arrays = self.hear()
            kind = header["type"]
            self.log.append(kind)
            self.step, self.attempt = header["step"], header["attempt"]
            if kind == "welcome":
                self.session = header["session"]
            elif kind == "configure":
                self.scene = yaml.safe_load(header["body"]["scene"])
            elif kind == "mesh":
                self.take_mesh(arrays)
                # The fingerprint is XXH64 over the arrays as docs/protocol.md says.
                self.say("result", {"fingerprint": fingerprint(header, arrays)})
            elif kind == "start":
                self.answer(self.impulse(None, 0.0), {**self.law(), **self.solids()})
            elif kind == "offer":
                self.given = self.impulse(arrays, header["body"]["length"])
                self.say("result", {"wall_seconds": 0.0}, self.law())
            elif kind == "advance" and arrays:
                self.answer(self.impulse(arrays, header["body"]["length"]), {**self.law(), **self.solids()})
            elif kind == "advance":  # the offer has said the rest
                self.answer(self.given, self.solids())
            elif kind == "snapshot":
                self.say("result")
            elif kind == "bye":
                return
            elif kind in ("reject", "error"):
                raise RuntimeError(header["body"])

    def take_mesh(self, arrays):
        points, offsets, rings = arrays["points"], arrays["face_offsets"], arrays["face_points"]
        owner, neighbour = arrays["owner"], arrays["neighbour"]
        volumes = numpy.zeros(owner.max() + 1)
        for face, cell in enumerate(owner):
            ring = points[rings[offsets[face] : offsets[face + 1]]]
            area = 0.5 * sum(numpy.cross(ring[i] - ring[0], ring[i + 1] - ring[0]) for i in range(1, len(ring) - 1))
            volumes[cell] += ring.mean(axis=0) @ area / 3
            if face < len(neighbour):
                volumes[neighbour[face]] -= ring.mean(axis=0) @ area / 3
        self.volumes = volumes

    def impulse(self, fluid, length):
        given = numpy.zeros((len(self.volumes), 3))
        if fluid is not None and self.step > 1:
            # What the last fluid step handed over: drag, and the pressure gradient on the solids.
            given = length * self.drag * self.volumes[:, None] * fluid["velocity"]
            given = given - length * ((1 - self.voidage) * self.volumes)[:, None] * fluid["pressure_gradient"]
        return given

    def law(self):
        return {"drag_coefficient": self.drag * self.volumes, "drag_source": numpy.zeros((len(self.volumes), 3))}

    def solids(self):
        cells = len(self.volumes)
        return {"voidage": numpy.full(cells, self.voidage), "particle_velocity": numpy.zeros((cells, 3))}

    def answer(self, given, arrays):
        solids = (1 - self.voidage) * self.volumes.sum()
        self.say(
            "result",
            {"particle_volume": solids, "particle_count": 0.0, "particle_mass": 2500 * solids, "excess_moved": 0.0, "wall_seconds": 0.0},
            {**arrays, "impulse_given": given},
        )


# ---- XXH64 (https://github.com/Cyan4973/xxHash/blob/dev/doc/xxhash_spec.md), because Debian has no Python module of the base set -------

MASK = (1 << 64) - 1
P1, P2, P3, P4, P5 = 0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5


def rotate(value, bits):
    return ((value << bits) | (value >> (64 - bits))) & MASK


def mix(accumulator, lane):
    return rotate((accumulator + lane * P2) & MASK, 31) * P1 & MASK


def xxh64(data):
    at, size = 0, len(data)
    if size >= 32:
        lanes = [(P1 + P2) & MASK, P2, 0, -P1 & MASK]
        while at + 32 <= size:
            for i, word in enumerate(struct.unpack_from("<4Q", data, at)):
                lanes[i] = mix(lanes[i], word)
            at += 32
        digest = sum(rotate(lane, bits) for lane, bits in zip(lanes, (1, 7, 12, 18))) & MASK
        for lane in lanes:
            digest = ((digest ^ mix(0, lane)) * P1 + P4) & MASK
    else:
        digest = P5
    digest = (digest + size) & MASK
    while at + 8 <= size:
        digest = (rotate(digest ^ mix(0, struct.unpack_from("<Q", data, at)[0]), 27) * P1 + P4) & MASK
        at += 8
    if at + 4 <= size:
        digest = (rotate(digest ^ struct.unpack_from("<I", data, at)[0] * P1 & MASK, 23) * P2 + P3) & MASK
        at += 4
    while at < size:
        digest = rotate(digest ^ data[at] * P5 & MASK, 11) * P1 & MASK
        at += 1
    for shift, prime in ((33, P2), (29, P3), (32, 1)):
        digest = (digest ^ digest >> shift) * prime & MASK
    return digest


def fingerprint(header, arrays):
    data = b""
    for name in ("points", "face_offsets", "face_points", "owner", "neighbour", "periodic_faces", "translations"):
        data += struct.pack("<Q", len(arrays[name])) + arrays[name].tobytes()
    first = len(arrays["neighbour"])
    for name in header["body"]["patches"]:
        size = header["body"]["patch_size:" + name]
        data += struct.pack("<Q", len(name)) + name.encode() + struct.pack("<Q2i", 2, first, size)
        first += size
    return f"{xxh64(data):016x}"


if __name__ == "__main__":
    Participant(sys.argv[1], voidage=float(sys.argv[2]), drag=float(sys.argv[3])).serve()
