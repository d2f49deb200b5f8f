"""A mechanism's bodies hang together: one joint carries each, down to the ground."""

from collections.abc import Iterator

from schemas.errors import Issue
from schemas.mechanisms import GROUND, Floating, Mechanism
from schemas.pointers import Part, pointer
from schemas.problem import Problem

_CIRCLE = (
    "joints make a tree from the ground up: take one joint of the circle away and close it by a "
    "pin in 'loops'"
)


def check(problem: Problem) -> Iterator[Issue]:
    """Bodies on two joints, on none, on each other; mechanisms that cannot move."""
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Mechanism):
            yield from _tree(phase.system, ("phases", index, "system"))


def _tree(system: Mechanism, root: tuple[Part, ...]) -> Iterator[Issue]:
    carried: dict[str, str] = {}
    for name, joint in system.joints.items():
        place = pointer(*root, "joints", name, "child")
        if joint.child == GROUND:
            yield Issue(place, "the ground is carried by nothing", "swap 'parent' and 'child'")
        elif joint.child in carried:
            message = f"'{joint.child}' hangs on the joint '{carried[joint.child]}' already"
            yield Issue(place, message, _CIRCLE)
        carried.setdefault(joint.child, name)
    yield from _loose_bodies(system, carried, root)
    if system.links and not system.coordinates:
        yield Issue(
            pointer(*root, "joints"),
            "nothing moves: every joint is welded",
            "a body moves by a joint of another kind: revolute, prismatic, floating",
        )


def _loose_bodies(
    system: Mechanism, carried: dict[str, str], root: tuple[Part, ...]
) -> Iterator[Issue]:
    linked = {link.body for link in system.links}
    for body in system.bodies:
        if body not in carried:
            yield Issue(
                pointer(*root, "bodies", body),
                f"'{body}' hangs on no joint",
                f'give it one; free in the plane is {{"kind": "floating", "child": "{body}"}}',
            )
            continue
        circle = [] if body in linked else _circle(system, carried, body)
        if carried[body] in circle:
            told = ", ".join(f"'{one}'" for one in circle)
            message = f"the joints {told} carry each other in a circle, and nothing carries them"
            yield Issue(pointer(*root, "joints", carried[body], "parent"), message, _CIRCLE)
            return


def _circle(system: Mechanism, carried: dict[str, str], body: str) -> list[str]:
    """The joints from a body down until they repeat; none where they end elsewhere."""
    way: list[str] = []
    while body in carried and carried[body] not in way:
        way.append(carried[body])
        joint = system.joints[carried[body]]
        body = GROUND if isinstance(joint, Floating) else joint.parent
    return way[way.index(carried[body]) :] if body in carried else []
