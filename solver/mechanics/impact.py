"""Impacts: velocities jump, places do not; impulses act where contacts touch afterwards.

``M(q) (v+ - v-) = J' L`` (the collision of 003, section 7.16.3, without its bookkeeping: momenta
about joints are what M carries). The jump is written over places before it; M by the partial
velocities of all centres of mass, so nothing is solved.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from schemas.expressions import Call, Name, Tree
from schemas.expressions.differentiation import total_derivative
from schemas.mechanisms import GROUND, Body, Floating, Joint, Mechanism, Prismatic
from schemas.mechanisms.parts import ONE as UNIT
from schemas.mechanisms.parts import ZERO as NOTHING
from schemas.mechanisms.parts import origin
from solver.mechanics.frames import Frames
from solver.mechanics.loads import Load
from solver.mechanics.series import centres
from solver.mechanics.touching import Touch, touches
from solver.mechanics.trees import ONE, ZERO, Vec, dot, less, minus, plus, times

PIN = ("#pin_x", "#pin_y")
"""The coordinates of a freed pin, m; no user can write them."""


@dataclass(slots=True)
class Shock:
    """A mechanism at an impact, all trees over its places.

    ``touching`` are its pairs by name.
    """

    mechanism: Mechanism
    frames: Frames
    touching: Mapping[str, Touch]
    middles: Mapping[str, Vec]
    _known: dict[tuple[str, str], Tree] = field(default_factory=dict)
    _motions: dict[tuple[str, str], tuple[Vec, Tree]] = field(default_factory=dict)
    _masses: dict[tuple[str, str], Tree] = field(default_factory=dict)

    @classmethod
    def of(cls, mechanism: Mechanism) -> "Shock":
        """Of a mechanism, freed where it is pinned (`freed`)."""
        frames = Frames.of(mechanism)
        middles = centres(frames)
        return cls(mechanism, frames, touches(frames), middles)

    def jump(
        self, row: str, change: Mapping[str, Tree], impulses: Mapping[str, tuple[Tree, Tree]]
    ) -> Tree:
        """``M dv - J' L`` of one coordinate; zero.

        ``change`` has v+ - v- for every coordinate, ``impulses`` the normal and the tangential
        one of every pair, N s.
        """
        inertia = [
            times(self.inertia(row, name), change[name]) for name in self.mechanism.coordinates
        ]
        pushes = [
            minus(times(impulse, self.push(pair, row, side)))
            for pair, both in impulses.items()
            for side, impulse in enumerate(both)
        ]
        return plus(*inertia, *pushes)

    def inertia(self, row: str, column: str) -> Tree:
        """An entry of the mass matrix."""
        key = (row, column) if row <= column else (column, row)
        if key not in self._masses:
            self._masses[key] = self._mass(row, column)
        return self._masses[key]

    def _mass(self, row: str, column: str) -> Tree:
        terms: list[Tree] = []
        for name in self.middles:
            body = self.mechanism.bodies[name]
            (one, turn), (two, bend) = (self._moved(name, each) for each in (row, column))
            if body.mass is not None:
                terms.append(times(body.mass.tree, dot(one, two)))
            if body.inertia is not None:
                terms.append(times(body.inertia.tree, turn, bend))
        return plus(*terms)

    def _moved(self, body: str, coordinate: str) -> tuple[Vec, Tree]:
        """How a coordinate moves a body's centre of mass, and how it turns the body."""
        key = body, coordinate
        if key not in self._motions:
            turn = self.partial(self.frames.angle(body), coordinate)
            self._motions[key] = self._along(self.middles[body], coordinate), turn
        return self._motions[key]

    def push(self, pair: str, row: str, side: int) -> Tree:
        """What a unit impulse along a pair's normal (0) or tangent (1) does to a coordinate."""
        unit = ((ONE, ZERO), (ZERO, ONE))[side]
        return plus(*(self._acts(load, row) for load in self.touching[pair].loads(*unit)))

    def _acts(self, load: Load, row: str) -> Tree:
        place = self.frames.world(load.place, load.body)
        turn = self.partial(self.frames.angle(load.body), row)
        return plus(dot(load.force, self._along(place, row)), times(load.couple, turn))

    def _along(self, place: Vec, coordinate: str) -> Vec:
        return self.partial(place[0], coordinate), self.partial(place[1], coordinate)

    def partial(self, tree: Tree, coordinate: str) -> Tree:
        """How a tree over places changes with a coordinate."""
        if isinstance(tree, Name):
            return self._name(tree.name, coordinate)
        if isinstance(tree, Call) and tree.function in ("+", "-", "neg", "*"):
            return self._folded(tree, coordinate)
        return total_derivative(tree, lambda name: self._name(name, coordinate))

    def _folded(self, tree: Call, coordinate: str) -> Tree:
        """Sums and products of what the frames are made of, without zeros."""
        slopes = [self.partial(one, coordinate) for one in tree.arguments]
        if tree.function == "neg":
            return minus(slopes[0])
        if tree.function == "-":
            return less(slopes[0], slopes[1])
        if tree.function == "+":
            return plus(*slopes)
        rest = [
            (*tree.arguments[:i], slope, *tree.arguments[i + 1 :]) for i, slope in enumerate(slopes)
        ]
        return plus(*(times(*factors) for factors in rest))

    def _name(self, name: str, coordinate: str) -> Tree:
        if name == coordinate:
            return ONE
        key = name, coordinate
        if key not in self._known:
            self._known[key] = self._partial(name, coordinate)
        return self._known[key]

    def _partial(self, name: str, coordinate: str) -> Tree:
        body, mark, word = name.rpartition("#")
        if mark and word in ("cos", "sin") and body in self.frames.carried:
            turn = self.partial(self.frames.angle(body), coordinate)
            c, s = self.frames.heading(body)
            return times(turn, minus(s) if word == "cos" else c)
        tree = self.frames.trees.get(name)
        return ZERO if tree is None else self.partial(tree, coordinate)


def freed(mechanism: Mechanism, joint: str) -> Mechanism:
    """The mechanism on two slides at the pin: what an impact elsewhere lets go of the ground."""
    root = mechanism.joints[joint]
    if isinstance(root, Floating):
        return mechanism
    axes = (UNIT, NOTHING), (NOTHING, UNIT)
    joints: dict[str, Joint] = {}
    parent = GROUND
    for name, axis in zip(PIN, axes, strict=True):
        joints[name] = Prismatic.model_construct(
            kind="prismatic",
            parent=parent,
            child=f"{name}_slide",
            at=root.at if parent == GROUND else origin(),
            to=origin(),
            angle=NOTHING,
            axis=list(axis),
            limits=None,
        )
        parent = f"{name}_slide"
    joints |= mechanism.joints
    joints[joint] = root.model_copy(update={"parent": parent, "at": origin()})
    slides = {f"{name}_slide": Body() for name in PIN}
    fields = {name: getattr(mechanism, name) for name in type(mechanism).model_fields}
    # made anew, so that nothing cached of the pinned one stays
    return Mechanism.model_construct(
        **{**fields, "joints": joints, "bodies": {**slides, **mechanism.bodies}}
    )


def pin_of(mechanism: Mechanism, contact: str) -> str | None:
    """The joint to the ground at a contact point, if there is one."""
    place = mechanism.contacts[mechanism.touching[contact].contact]
    return next(_pins(mechanism, place.body, [one.tree for one in place.at]), None)


def _pins(mechanism: Mechanism, body: str, at: list[Tree]) -> Iterator[str]:
    for name, joint in mechanism.joints.items():
        if isinstance(joint, Floating) or joint.parent != GROUND or joint.child != body:
            continue
        if [one.tree for one in joint.to] == at:
            yield name
