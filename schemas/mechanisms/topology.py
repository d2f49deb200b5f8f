"""The tree of a mechanism: which body hangs on which, and the coordinates that this makes.

The language's own reading of a mechanism, shared by all who work on one: no physics.
"""

from collections.abc import Mapping
from typing import NamedTuple, assert_never

from schemas.mechanisms.parts import GROUND, Floating, Joint, Prismatic, Revolute, Welded


class Link(NamedTuple):
    """A body with the joint that carries it. ``coordinates`` are those of the joint."""

    body: str
    joint_name: str
    joint: Joint
    parent: str
    coordinates: tuple[str, ...]


def links(joints: Mapping[str, Joint], *, absolute: bool) -> list[Link]:
    """Every body that the ground carries, parents first; joints in the order of the document.

    What hangs on nothing, or on two joints, is left out: `schemas.checks` names it.
    """
    made: dict[str, Link] = {}
    pending = list(joints.items())
    while pending:
        later = []
        for name, joint in pending:
            parent = GROUND if isinstance(joint, Floating) else joint.parent
            if joint.child in made or joint.child == GROUND:
                continue
            if parent == GROUND or parent in made:
                own = coordinates(name, joint, absolute=absolute)
                made[joint.child] = Link(joint.child, name, joint, parent, own)
            else:
                later.append((name, joint))
        if len(later) == len(pending):
            break
        pending = later
    return list(made.values())


def coordinates(name: str, joint: Joint, *, absolute: bool) -> tuple[str, ...]:
    """The coordinates of a joint: its own name, or the child's place and angle."""
    match joint:
        case Floating():
            return tuple(f"{joint.child}.{one}" for one in ("x", "y", "angle"))
        case Revolute():
            return (f"{joint.child}.angle",) if absolute else (name,)
        case Prismatic():
            return (name,)
        case Welded():
            return ()
        case _:
            assert_never(joint)
