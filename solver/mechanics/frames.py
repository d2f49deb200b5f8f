"""Where the bodies of a mechanism are: places as trees, their rates left to differentiation.

All vectors of a body are kept in the frame of its *turner*, the body whose hinge (or free
flight) turns it: welded and sliding bodies share the sine and cosine of one absolute angle. Its
*mount* is the body whose joint carries it along: places are counted from the mount's pin.

Sine and cosine come with their first and second derivatives, so that everything else, also the
acceleration of every place, is linear in few shared names (``B#cos``, ``d(B#cos)``,
``dd(B#cos)``).
"""

from dataclasses import dataclass, field

from schemas.expressions import Name, Number, Tree, derivative
from schemas.mechanisms import (
    GROUND,
    Floating,
    Link,
    Mechanism,
    Place,
    Prismatic,
    Revolute,
    Welded,
)
from solver.mechanics.trees import (
    ONE,
    ORIGIN,
    ZERO,
    Vec,
    apart,
    both,
    call,
    minus,
    plus,
    scaled,
    square,
    times,
    turned,
    unit,
    vector,
)


@dataclass(frozen=True, slots=True)
class Frame:
    """A body's frame in the terms of its mount and its turner.

    Attributes
    ----------
    turn
        Constant angle from the turner's frame to the body's, and its cosine and sine.
    origin
        The body's origin, from the mount's pin, in the turner's frame.
    """

    mount: str
    turner: str
    turn: Tree
    bearing: Vec
    origin: Vec

    def at(self, place: Vec) -> Vec:
        """A place of the body, from the mount's pin in the turner's frame."""
        return both(self.origin, turned(self.bearing, place))


@dataclass(frozen=True, slots=True)
class Carried:
    """How a joint carries its child: ``lever`` from the parent's pin to that of the child.

    ``axis`` is a slider's; both in the frame of the parent's turner.
    """

    link: Link
    lever: Vec
    axis: Vec


_FIXED = Frame(GROUND, GROUND, ZERO, (ONE, ZERO), ORIGIN)


@dataclass(slots=True)
class Frames:
    """The frames of all bodies, and definitions of what they share."""

    mechanism: Mechanism
    trees: dict[str, Tree] = field(default_factory=dict)
    frames: dict[str, Frame] = field(default_factory=lambda: {GROUND: _FIXED})
    carried: dict[str, Carried] = field(default_factory=dict)
    pins: dict[str, Vec] = field(default_factory=lambda: {GROUND: ORIGIN})

    @classmethod
    def of(cls, mechanism: Mechanism) -> "Frames":
        """Go through the tree, parents first."""
        self = cls(mechanism)
        for link in mechanism.links:
            self._carry(link)
        return self

    @property
    def links(self) -> list[Link]:
        """Bodies and their joints, parents first."""
        return self.mechanism.links

    def heading(self, turner: str) -> Vec:
        """Cosine and sine of a turner's angle."""
        return (ONE, ZERO) if turner == GROUND else (Name(f"{turner}#cos"), Name(f"{turner}#sin"))

    def angle(self, body: str) -> Tree:
        """The absolute angle of a body."""
        return ZERO if body == GROUND else Name(f"{body}.angle")

    def world(self, place: Vec, body: str) -> Vec:
        """A place of a body, in the world."""
        frame = self.frames[body]
        return both(self.pins[frame.mount], turned(self.heading(frame.turner), frame.at(place)))

    def place(self, place: Place) -> Vec:
        """A place that a user gave, in the world."""
        return self.world(vector(place.at), place.body)

    def direction(self, along: Vec, body: str) -> Vec:
        """A direction of a body, in the world."""
        frame = self.frames[body]
        return turned(self.heading(frame.turner), turned(frame.bearing, along))

    def _carry(self, link: Link) -> None:
        match link.joint:
            case Floating():
                self.pins[link.body] = Name(f"{link.body}.x"), Name(f"{link.body}.y")
                self._turns(link, ORIGIN, ORIGIN)
            case Revolute() as joint:
                lever = self.frames[link.parent].at(vector(joint.at))
                self._hinge(link, joint)
                self._pin(link.body, self.world(vector(joint.at), link.parent))
                self._turns(link, lever, scaled(minus(ONE), vector(joint.to)))
            case Prismatic() as joint:
                self._slide(link, joint)
            case Welded() as joint:
                parent, turn, bearing = self._turned(link, joint)
                spot = parent.at(vector(joint.at))
                origin = apart(spot, turned(bearing, vector(joint.to)))
                self.frames[link.body] = Frame(parent.mount, parent.turner, turn, bearing, origin)

    def _turned(self, link: Link, joint: Prismatic | Welded) -> tuple[Frame, Tree, Vec]:
        """The parent's frame, and the child's angle in the turner's frame."""
        parent = self.frames[link.parent]
        turn = plus(parent.turn, joint.angle.tree)
        self.trees[f"{link.body}.angle"] = plus(self.angle(parent.turner), turn)
        return parent, turn, (call("cos", turn), call("sin", turn))

    def _hinge(self, link: Link, joint: Revolute) -> None:
        """The absolute angle by the joint's, or the other way round."""
        before = plus(self.angle(link.parent), joint.angle.tree)
        own = f"{link.body}.angle"
        if link.coordinates == (own,):
            self.trees[link.joint_name] = plus(Name(own), minus(before))
        else:
            self.trees[own] = plus(before, Name(link.joint_name))

    def _turns(self, link: Link, lever: Vec, origin: Vec) -> None:
        body = link.body
        self.carried[body] = Carried(link, lever, ORIGIN)
        self.frames[body] = Frame(body, body, ZERO, (ONE, ZERO), origin)
        self._heading(body)

    def _slide(self, link: Link, joint: Prismatic) -> None:
        parent, turn, bearing = self._turned(link, joint)
        axis = turned(parent.bearing, unit(vector(joint.axis)))
        lever = both(parent.at(vector(joint.at)), scaled(Name(link.joint_name), axis))
        origin = scaled(minus(ONE), turned(bearing, vector(joint.to)))
        heading = self.heading(parent.turner)
        self.carried[link.body] = Carried(link, lever, axis)
        self.frames[link.body] = Frame(link.body, parent.turner, turn, bearing, origin)
        self._pin(link.body, both(self.pins[parent.mount], turned(heading, lever)))

    def _pin(self, body: str, pin: Vec) -> None:
        names = f"{body}#px", f"{body}#py"
        self.pins[body] = self.shared(names[0], pin[0]), self.shared(names[1], pin[1])

    def shared(self, name: str, tree: Tree) -> Tree:
        """The tree under a name of its own, so that it has a rate; numbers need none."""
        if isinstance(tree, Number):
            return tree
        self.trees[name] = tree
        return Name(name)

    def _heading(self, body: str) -> None:
        """Sine, cosine and their derivatives, over shared names."""
        angle = f"{body}.angle"
        c, s = Name(f"{body}#cos"), Name(f"{body}#sin")
        speed, turning = Name(derivative(angle)), Name(derivative(angle, 2))
        squared = Name(f"{body}#speed2")
        self.trees |= {
            c.name: call("cos", Name(angle)),
            s.name: call("sin", Name(angle)),
            squared.name: square(speed),
            derivative(c.name): minus(times(speed, s)),
            derivative(s.name): times(speed, c),
            derivative(c.name, 2): minus(plus(times(turning, s), times(squared, c))),
            derivative(s.name, 2): plus(times(turning, c), minus(times(squared, s))),
        }


def rate(tree: Tree, order: int = 1) -> Tree:
    """The derivative of what is a name or a number."""
    if isinstance(tree, Name):
        return Name(derivative(tree.name, order))
    return ZERO


def rates(pair: Vec, order: int = 1) -> Vec:
    """The derivatives of two names or numbers."""
    return rate(pair[0], order), rate(pair[1], order)
