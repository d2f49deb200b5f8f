"""How the bodies of a URDF system move: velocities and accelerations from the base to the tips.

Every vector is in its own body's axes (Featherstone 2008, table 5.1, here with the acceleration of
the frame's origin in place of the spatial one). Gravity is an acceleration of the world upwards.
The field of accelerations around an origin is ``a + B x``, with
``B = [alpha]x + w w' - w'w 1``: one matrix serves children, mass and inertia.
"""

from dataclasses import dataclass, field

from schemas.expressions import Name, Number, Tree
from schemas.urdf import WORLD, Pose, Urdf
from solver.mechanics.spatial_bodies import Bodies, Body
from solver.mechanics.spatial_turns import Turn, back, combined, forth, turn_of
from solver.mechanics.spatial_vectors import (
    AXES,
    NOWHERE,
    Mat3,
    Vec3,
    applied,
    columns,
    constant,
    cross,
    matrix,
    scaled,
    total,
    turned,
    unturned,
    written,
)
from solver.mechanics.trees import ONE, ZERO, less, minus, plus, square, times

_STILL: Mat3 = (NOWHERE, NOWHERE, NOWHERE)
_UPRIGHT: Mat3 = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))


@dataclass(slots=True)
class Motions:
    """Names of all bodies' velocities and accelerations, and what they stand for.

    Attributes
    ----------
    spins, drags
        Angular velocities, and those of the frames' origins.
    fields
        The matrix B of every body.
    pushes
        Accelerations of the frames' origins, gravity taken off.
    axes, origins
        Where the frames are in the world: rotations, and places in m.
    """

    system: Urdf
    bodies: Bodies
    trees: dict[str, Tree] = field(default_factory=dict)
    turns: dict[str, Turn] = field(default_factory=dict)
    spins: dict[str, Vec3] = field(default_factory=lambda: {WORLD: NOWHERE})
    turnings: dict[str, Vec3] = field(default_factory=lambda: {WORLD: NOWHERE})
    drags: dict[str, Vec3] = field(default_factory=lambda: {WORLD: NOWHERE})
    fields: dict[str, Mat3] = field(default_factory=lambda: {WORLD: _STILL})
    pushes: dict[str, Vec3] = field(default_factory=dict)
    axes: dict[str, Mat3] = field(default_factory=lambda: {WORLD: _UPRIGHT})
    origins: dict[str, Vec3] = field(default_factory=lambda: {WORLD: NOWHERE})

    @classmethod
    def of(cls, system: Urdf) -> "Motions":
        """Go through the tree, parents first."""
        self = cls(system, Bodies.of(system))
        self.pushes[WORLD] = scaled(Number(-1.0), written(system.gravity))
        for body in self.bodies.bodies.values():
            self.turns[body.name] = turn_of(body.name, body.step, self.trees)
            self._velocities(body)
            self._accelerations(body)
            self._places(body)
        return self

    def into(self, body: Body, vector: Vec3) -> Vec3:
        """A vector in the parent's axes, in the body's own."""
        return back(self.turns[body.name], unturned(body.pose.axes, vector))

    def out(self, body: Body, vector: Vec3) -> Vec3:
        """A vector in the body's axes, in the parent's."""
        return turned(body.pose.axes, forth(self.turns[body.name], vector))

    def lever(self, body: Body) -> Vec3:
        """From the parent's origin to the body's, in the parent's axes."""
        slide = turned(body.pose.axes, self.turns[body.name].slide)
        return total(constant(body.pose.origin), slide)

    def _velocities(self, body: Body) -> None:
        turn, name, parent = self.turns[body.name], body.name, body.parent
        before = self.spins[parent]
        self.spins[name] = self.shared(f"{name}#w", total(self.into(body, before), turn.spin))
        sliding = turned(body.pose.axes, turn.sliding)
        moved = total(self.drags[parent], cross(before, self.lever(body)), sliding)
        self.drags[name] = self.shared(f"{name}#v", self.into(body, moved))

    def _accelerations(self, body: Body) -> None:
        turn, name, parent = self.turns[body.name], body.name, body.parent
        swept = self.into(body, self.spins[parent])
        own = total(self.into(body, self.turnings[parent]), combined(turn, swept))
        self.turnings[name] = self.shared(f"{name}#u", own)
        self.fields[name] = self._field(name)
        slid = total(
            turned(body.pose.axes, turn.pushed),
            scaled(Number(2.0), cross(self.spins[parent], turned(body.pose.axes, turn.sliding))),
        )
        push = total(self.pushes[parent], applied(self.fields[parent], self.lever(body)), slid)
        self.pushes[name] = self.shared(f"{name}#a", self.into(body, push))

    def _field(self, name: str) -> Mat3:
        """B of a body."""
        x, y, z = self.spins[name]
        u, v, w = self.turnings[name]
        xx, yy, zz = (
            self.scalar(f"{name}#q{one}", square(s)) for one, s in zip(AXES, (x, y, z), strict=True)
        )
        xy, xz, yz = (
            self.scalar(f"{name}#q{one}", times(*pair))
            for one, pair in (("xy", (x, y)), ("xz", (x, z)), ("yz", (y, z)))
        )
        rows = (
            (minus(plus(yy, zz)), less(xy, w), plus(xz, v)),
            (plus(xy, w), minus(plus(xx, zz)), less(yz, u)),
            (less(xz, v), plus(yz, u), minus(plus(xx, yy))),
        )
        first, second, third = (
            self.shared(f"{name}#b{number}", row) for number, row in enumerate(rows, start=1)
        )
        return first, second, third

    def _places(self, body: Body) -> None:
        """The frame in the world; nobody pays for it who does not ask."""
        parent, name = body.parent, body.name
        here = total(self.origins[parent], applied(self.axes[parent], self.lever(body)))
        self.origins[name] = self.shared(f"{name}#p", here)
        rows = [self.into(body, row) for row in self.axes[parent]]
        first, second, third = (
            self.shared(f"{name}#r{number}", row) for number, row in enumerate(rows, start=1)
        )
        self.axes[name] = first, second, third

    def shared(self, prefix: str, vector: Vec3) -> Vec3:
        """A vector under names of its own, but for entries that are names or numbers already."""
        x, y, z = (
            self.scalar(f"{prefix}{axis}", entry) for axis, entry in zip(AXES, vector, strict=True)
        )
        return x, y, z

    def scalar(self, name: str, tree: Tree) -> Tree:
        """A tree under a name of its own, unless it is a name or a number already."""
        if isinstance(tree, Name | Number):
            return tree
        self.trees[name] = tree
        return Name(name)

    def place(self, host: tuple[str, Pose], at: Vec3) -> Vec3:
        """A place of a link, in its body's axes, from its body's origin."""
        return total(constant(host[1].origin), turned(host[1].axes, at))

    def world(self, body: str, vector: Vec3) -> Vec3:
        """A vector of a body's axes, in the world's."""
        return applied(self.axes[body], vector)

    def local(self, body: str, vector: Vec3) -> Vec3:
        """A vector of the world's axes, in a body's."""
        return applied(columns(self.axes[body]), vector)

    def located(self, body: str, at: Vec3) -> tuple[Vec3, Vec3, Vec3]:
        """Place, velocity and acceleration in the world of a point of a body, at ``at`` in it."""
        place = total(self.origins[body], self.world(body, at))
        velocity = self.world(body, total(self.drags[body], cross(self.spins[body], at)))
        push = total(self.pushes[body], applied(self.fields[body], at))
        gravity = written(self.system.gravity)
        return place, velocity, total(self.world(body, push), gravity)

    def oriented(self, host: tuple[str, Pose]) -> Mat3:
        """The rotation of a link in the world."""
        body, pose = host
        first, second, third = (unturned(pose.axes, row) for row in self.axes[body])
        return first, second, third


def moments(body: Body) -> Mat3:
    """``S = 1/2 tr(I) 1 - I``, the second moments of mass about the frame's origin."""
    half = sum(body.inertia[k][k] for k in range(3)) / 2
    rows = [[(half if i == j else 0.0) - body.inertia[i][j] for j in range(3)] for i in range(3)]
    first, second, third = ((row[0], row[1], row[2]) for row in rows)
    return matrix((first, second, third))
