"""What contact-implicit steps add to a phase, and how its rows and bounds are written."""

import math
from dataclasses import dataclass, field

from schemas.expressions import Call, Name, Tree
from schemas.mechanisms import Mechanism
from schemas.phases import Constraint
from schemas.urdf import Urdf
from schemas.values import Bound, Scalar
from solver.complementarity import Pair
from solver.contact.names import LimitNames
from solver.hybrid.modes import limited

OPEN = math.inf

Start = tuple[tuple[str, ...], Constraint]
"""What holds where a phase begins, unless all of these names are given there."""


@dataclass(slots=True)
class Forces:
    """What contact-implicit steps add to a phase.

    Attributes
    ----------
    system
        The system, with the forces as controls.
    bounds, rows
        Of the new controls, and between them.
    pairs
        What is complementary.
    gaps
        The names of the gaps.
    starts
        What else holds where the phase begins, unless all the names beside it are given there.
    """

    system: Mechanism | Urdf
    bounds: dict[str, Bound] = field(default_factory=dict)
    rows: list[Constraint] = field(default_factory=list)
    pairs: list[Pair] = field(default_factory=list)
    gaps: list[str] = field(default_factory=list)
    starts: list[Start] = field(default_factory=list)

    def stop(self, joint: str, side: str, away: Tree, size: float) -> None:
        """One side of a joint's limits pushes back where it is reached (000, section 3.3).

        ``side`` is lower or upper; ``away`` how far it is, m or rad; ``size`` a typical effort.
        """
        names = LimitNames(joint)
        below = side == "lower"
        room, push = (names.below, names.lower) if below else (names.above, names.upper)
        self.bounds |= {push: bound(0.0), room: bound(0.0)}
        self.rows.append(same(f"{joint} {side} limit", room, away))
        label = f"start of {joint} {side} limit"
        row = limited(label, label, at_start(away))
        self.starts.append((tuple(self.system.coordinates), row))
        self.pairs.append(Pair(0, f"{joint} {side} stop", room, push, (1.0, size), "limit"))


def at_start(tree: Tree) -> Tree:
    """A tree over values at the phase's start."""
    if isinstance(tree, Name):
        return Name(f"initial.{tree.name}")
    if isinstance(tree, Call):
        return Call(tree.function, tuple(at_start(one) for one in tree.arguments))
    return tree


def effort(joint: str, lower: float, upper: float) -> Tree | None:
    """What the stops of a joint do together: lower less upper; None where both are open."""
    names = LimitNames(joint)
    terms: list[Tree] = [Name(names.lower)] if math.isfinite(lower) else []
    terms += [Call("neg", (Name(names.upper),))] if math.isfinite(upper) else []
    return Call("+", tuple(terms)) if len(terms) > 1 else next(iter(terms), None)


def same(label: str, name: str, tree: Tree) -> Constraint:
    """A row that makes a variable what a tree says."""
    return limited(label, label, Call("-", (tree, Name(name))), (0.0, 0.0))


def bound(lower: float, upper: float = OPEN) -> Bound:
    """Limits; infinite ones are none."""
    sides = (Scalar(side) if math.isfinite(side) else None for side in (lower, upper))
    return Bound(*sides)
