"""Forces on bodies, and the generalized forces that they make: recursive Newton-Euler, backward.

A force acts at a place of a body and is carried down to the ground: at every mount the forces
above are added up, and for every turner the moments about its pin. Forces stay in the world's
frame; moments of places ``v`` fixed in a turner's frame are ``c A - s B`` with sums
``A = v_x F_y - v_y F_x`` and ``B = v_x F_x + v_y F_y``, so each turner costs one projection.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import assert_never

from schemas.expressions import Call, Name, Tree
from schemas.mechanisms import GROUND, Floating, Link, Prismatic, Revolute, Welded
from solver.mechanics.frames import Frames
from solver.mechanics.trees import ORIGIN, ZERO, Vec, cross, dot, less, minus, plus, times


@dataclass(frozen=True, slots=True)
class Load:
    """A force in the world's frame at a place of a body, N, and a couple, N m.

    ``place`` is in the body's own frame.
    """

    body: str
    place: Vec = ORIGIN
    force: Vec = ORIGIN
    couple: Tree = ZERO


def opposite(load: Load) -> Load:
    """The load that balances this one."""
    return Load(
        load.body, load.place, (minus(load.force[0]), minus(load.force[1])), minus(load.couple)
    )


@dataclass(slots=True)
class Balance:
    """Sums of loads, from the tips of the tree to the ground; ``trees`` are their definitions."""

    frames: Frames
    trees: dict[str, Tree] = field(default_factory=dict)
    _forces: dict[str, list[Vec]] = field(default_factory=lambda: defaultdict(list))
    _moments: dict[str, list[Tree]] = field(default_factory=lambda: defaultdict(list))
    _along: dict[str, list[Tree]] = field(default_factory=lambda: defaultdict(list))
    _couples: dict[str, list[Tree]] = field(default_factory=lambda: defaultdict(list))

    def add(self, loads: Iterable[Load]) -> None:
        """Let loads act."""
        for load in loads:
            frame = self.frames.frames[load.body]
            self._act(frame.mount, frame.turner, frame.at(load.place), load.force)
            self._couples[frame.turner].append(load.couple)

    def generalized(self, efforts: Mapping[str, Tree]) -> dict[str, Tree]:
        """The generalized force of every coordinate; ``efforts`` are those of joints, by name."""
        found: dict[str, Tree] = {}
        for link in reversed(self.frames.links):
            found |= self._carried(link, efforts.get(link.joint_name, ZERO))
        return {name: found[name] for name in self.frames.mechanism.coordinates}

    def _act(self, mount: str, turner: str, lever: Vec, force: Vec) -> None:
        self._forces[mount].append(force)
        self._moments[turner].append(cross(lever, force))
        self._along[turner].append(dot(lever, force))

    def _carried(self, link: Link, effort: Tree) -> dict[str, Tree]:
        """Hand on what a body's joint carries; what is left along its coordinates."""
        if link.body not in self.frames.carried:
            return {}
        force = self._total(link.body)
        match link.joint:
            case Floating():
                return dict(zip(link.coordinates, (*force, self._moment(link.body)), strict=True))
            case Revolute():
                return {link.coordinates[0]: self._hinged(link, force, effort)}
            case Prismatic():
                parent = self.frames.frames[link.parent]
                carried = self.frames.carried[link.body]
                self._act(parent.mount, parent.turner, carried.lever, force)
                c, s = self.frames.heading(parent.turner)
                lengthwise = plus(times(c, force[0]), times(s, force[1]))
                across = less(times(c, force[1]), times(s, force[0]))
                return {
                    link.joint_name: plus(dot(carried.axis, (lengthwise, across)), effort),
                }
            case Welded():  # what it carries has its body's mount, and is carried by that
                return {}
            case _:
                assert_never(link.joint)

    def _hinged(self, link: Link, force: Vec, effort: Tree) -> Tree:
        parent = self.frames.frames[link.parent]
        lever = self.frames.carried[link.body].lever
        self._act(parent.mount, parent.turner, lever, force)
        moment = self._moment(link.body)
        if link.coordinates == (link.joint_name,):  # the angle to the parent turns all above
            if parent.turner != GROUND:
                moment = self._shared(f"{link.body}#moment", moment)
                self._couples[parent.turner].append(moment)
        else:
            self._couples[parent.turner].append(minus(effort))
        return plus(moment, effort)

    def _total(self, mount: str) -> Vec:
        forces = self._forces[mount]
        x, y = (plus(*(force[side] for force in forces)) for side in (0, 1))
        return self._shared(f"{mount}#fx", x), self._shared(f"{mount}#fy", y)

    def _moment(self, turner: str) -> Tree:
        c, s = self.frames.heading(turner)
        a, b = plus(*self._moments[turner]), plus(*self._along[turner])
        return plus(*self._couples[turner], times(c, a), minus(times(s, b)))

    def _shared(self, name: str, tree: Tree) -> Tree:
        if not isinstance(tree, Call):
            return tree
        self.trees[name] = tree
        return Name(name)
