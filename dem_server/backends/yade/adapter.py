"""YADE as a process of its own, which does what its particle server asks (yade_process.hpp).

    adapter.py ENDPOINT SERVER_PID YADE_MODULES

Messages have the form of docs/protocol.md: an `advance` asks, `call` in its body says what for, and `result` or `error` answers.

The committed state is kept by a copy of this process (fork shares the memory until either writes to it): before a window the copy is
made and sleeps; after `commit` it ends; after `rollback` this process ends and the copy goes on in its place, so that nothing of the
window is left, to the bit.
"""

import ctypes
import os
import select
import shutil
import signal
import socket
import sys
import time

# Before the libraries start their threads: one, so that sums have one order and the copy misses nothing.
os.environ["OMP_NUM_THREADS"] = "1"
ENDPOINT, SERVER, MODULES = sys.argv[1], int(sys.argv[2]), sys.argv[3]
# Not the program `yade`, which opens Python prompts on TCP ports of this host.
sys.path.append(MODULES)

PR_SET_PDEATHSIG = 1
LIBC = ctypes.CDLL(None)


def end_with(parent):
    """Die when `parent`, which must be our parent now, does."""
    LIBC.prctl(PR_SET_PDEATHSIG, int(signal.SIGKILL))
    if os.getppid() != parent:
        os._exit(0)


def leave_no_folder():
    """A server that is killed cannot remove the folder of our socket: a small process waits for its end, and does."""
    watched = os.pidfd_open(SERVER)
    if os.fork() != 0:
        os.close(watched)
        return
    select.select([watched], [], [])
    shutil.rmtree(os.path.dirname(ENDPOINT.removeprefix("ipc://")), ignore_errors=True)
    os._exit(0)


end_with(SERVER)
leave_no_folder()

import msgpack
import numpy
import zmq
from yade import utils
from yade.wrapper import *

O = Omega()
os.rmdir(os.path.dirname(O.tmpFilename()))  # nothing here needs it, and whoever is killed leaves it behind
BEAT = 0.5  # [s] between signs of life
DTYPES = {"f64": "<f8", "i32": "<i4"}


class Peer:
    """The particle server."""

    def __init__(self):
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.DEALER)
        self.socket.linger = 5000
        self.socket.connect(ENDPOINT)
        self.sent = 0
        self.beaten = time.monotonic()
        self.say("hello", {"pid": os.getpid()})

    def leave(self):
        """When what was said last has left."""
        self.socket.close()
        self.context.term()

    def say(self, kind, body=None, arrays=None):
        arrays = {name: numpy.ascontiguousarray(array) for name, array in (arrays or {}).items()}
        names = {"f": "f64", "i": "i32"}
        header = {
            "version": 1,
            "type": kind,
            "session": "",
            "sequence": self.sent,
            "step": 0,
            "attempt": 0,
            "body": body or {},
            "arrays": [{"name": n, "dtype": names[a.dtype.kind], "shape": list(a.shape)} for n, a in arrays.items()],
        }
        self.sent += 1
        self.socket.send_multipart([msgpack.packb(header)] + [array.tobytes() for array in arrays.values()])

    def hear(self):
        frames = self.socket.recv_multipart()
        header = msgpack.unpackb(frames[0])
        arrays = {}
        for info, frame in zip(header["arrays"], frames[1:]):
            arrays[info["name"]] = numpy.frombuffer(frame, dtype=DTYPES[info["dtype"]]).reshape(info["shape"])
        return header["body"], arrays

    def beat(self):
        if time.monotonic() - self.beaten > BEAT:
            self.beaten = time.monotonic()
            self.say("heartbeat")


class Scene:
    """The bodies of YADE, one row a particle; walls are before them. All arrays as in yade_engine.cpp."""

    def __init__(self, peer):
        self.peer = peer
        self.ids, self.states = [], []
        self.materials, self.walls = [], []

    def configure(self, body, arrays):
        """Materials: those of the free particles first; the angle of friction of each two."""
        for kn, ks, cn, cs in zip(*(arrays[name].tolist() for name in ("kn", "ks", "cn", "cs"))):
            density = body["density"] if not self.materials else 0.0
            material = ViscElMat(kn=kn, ks=ks, cn=cn, cs=cs, frictionAngle=0.0, density=density)
            self.materials.append(O.materials.append(material))
        angles = arrays["friction_angle"].tolist()
        self.friction = [
            (a, b, angles[i * len(self.materials) + j]) for i, a in enumerate(self.materials) for j, b in enumerate(self.materials)
        ]
        self.walls = list(zip(arrays["wall_axis"].tolist(), arrays["wall_sense"].tolist(), arrays["wall_at"].tolist()))
        self.wall_material = self.materials[-1]
        self.skin = body["skin"]

    def build(self, arrays):
        """All bodies and contacts anew, so that what follows depends on these arrays alone."""
        O.interactions.clear()
        O.bodies.clear()
        O.forces.reset()
        O.resetTime()
        self.ids, self.states = [], []
        for axis, sense, at in self.walls:
            O.bodies.append(utils.wall(at, axis=axis, sense=sense, material=self.wall_material))
        self.add(arrays)
        O.engines = [
            ForceResetter(),
            InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=self.skin),
            InteractionLoop(
                [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
                [Ip2_ViscElMat_ViscElMat_ViscElPhys(frictAngle=MatchMaker(matches=self.friction))],
                [Law2_ScGeom_ViscElPhys_Basic()],
            ),
            NewtonIntegrator(damping=0),
        ]
        bodies = [body.id for body in O.bodies]
        pairs = arrays["contact"].reshape(-1, 2).tolist()
        for (one, other), force, normal in zip(pairs, arrays["shear_force"].tolist(), arrays["normal"].tolist()):
            contact = utils.createInteraction(bodies[one], bodies[other])
            contact.iterMadeReal = -1  # or the law takes it for a new one, which has no shear force yet
            contact.phys.shearForce = force
            contact.geom.normal = normal
            self.peer.beat()

    def add(self, arrays):
        columns = (arrays[name].tolist() for name in ("position", "velocity", "spin", "radius", "material"))
        for position, velocity, spin, radius, material in zip(*columns):
            free = material == 0
            body = utils.sphere(position, radius, material=self.materials[material], dynamic=free)
            if free:
                body.state.vel, body.state.angVel = velocity, spin
            self.ids.append(O.bodies.append(body))
            self.states.append(body.state)
            self.peer.beat()

    def contacts(self):
        """In YADE's order; bodies counted from the first wall on."""
        rank = {body.id: place for place, body in enumerate(O.bodies)}
        found = [(rank[i.id1], rank[i.id2], i.phys.shearForce, i.geom.normal) for i in O.interactions]
        return {
            "contact": numpy.array([c[:2] for c in found], dtype="<i4").reshape(-1),
            "shear_force": numpy.array([tuple(c[2]) for c in found], dtype="<f8").reshape(-1, 3),
            "normal": numpy.array([tuple(c[3]) for c in found], dtype="<f8").reshape(-1, 3),
        }

    def run(self, body, arrays):
        O.dt = body["time_step"]
        for state, velocity in zip(self.states, arrays["velocity"].tolist()):
            state.vel = velocity
        for _ in map(O.forces.setPermF, self.ids, arrays["force"].tolist()):
            pass
        for _ in range(body["sub_steps"]):
            O.step()
            self.peer.beat()
        return {name: self.read(name) for name in ("pos", "vel", "angVel")}

    def read(self, name):
        values = numpy.empty((len(self.states), 3))
        vectors = [getattr(state, name) for state in self.states]
        for axis in range(3):
            values[:, axis] = [vector[axis] for vector in vectors]
        return values

    def exchange(self, arrays):
        O.forces.reset()
        for row in reversed(arrays["leaving"].tolist()):
            O.bodies.erase(self.ids[row])
            del self.ids[row], self.states[row]
        self.add(arrays)


class Keeper:
    """The copy of this process that holds the committed state."""

    def make(self):
        """Returns False, and in the copy, if that is ever woken to go on in our place, True."""
        me = os.getpid()
        ours, theirs = socket.socketpair()
        pid = os.fork()
        if pid != 0:
            theirs.close()
            self.pid, self.line = pid, ours
            return False
        # What belongs to the other: a copy of a copy of a copy would run out of them.
        os.closerange(3, theirs.fileno())
        os.closerange(theirs.fileno() + 1, os.sysconf("SC_OPEN_MAX"))
        end_with(me)
        if not theirs.recv(1):  # closed: forgotten
            os._exit(0)
        LIBC.prctl(PR_SET_PDEATHSIG, 0)
        theirs.send(b"x")
        while os.getppid() == me:
            time.sleep(1e-3)
        end_with(SERVER)  # the server adopts what its children leave behind
        return True

    def forget(self):
        self.line.close()
        os.waitpid(self.pid, 0)

    def wake(self):
        """It must hear of it before we end, since it ends with us until then."""
        self.line.send(b"x")
        self.line.recv(1)


def answer(scene, call, body, arrays):
    if call == "configure":
        scene.configure(body, arrays)
    elif call == "build":
        scene.build(arrays)
    elif call == "contacts":
        return scene.contacts()
    elif call == "run":
        return scene.run(body, arrays)
    elif call == "exchange":
        scene.exchange(arrays)
    else:
        raise ValueError(f"unknown call {call!r}")
    return {}


def serve():
    peers = [Peer()]  # the last one; those before it are of processes that we were copied from, and never touched
    scene = Scene(peers[-1])
    keeper = Keeper()
    while True:
        body, arrays = peers[-1].hear()
        call = body["call"]
        if call == "run" and keeper.make():
            peers.append(Peer())
            scene.peer = peers[-1]
            continue
        if call == "rollback":
            peers[-1].say("result", {"successor": keeper.pid})
            peers[-1].leave()
            keeper.wake()
            os._exit(0)
        try:
            given = {}
            if call == "commit":
                keeper.forget()
            else:
                given = answer(scene, call, body, arrays)
            peers[-1].say("result", arrays=given)
        except Exception as error:  # YADE throws many kinds
            peers[-1].say("error", {"text": f"{call}: {type(error).__name__}: {error}"})


serve()
