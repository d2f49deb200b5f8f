"""Key poses are of planar mechanisms, of what a pose decides, and can be evaluated."""

from collections.abc import Iterator
from itertools import pairwise

from schemas.checks.constants import Constants
from schemas.errors import Issue
from schemas.expressions import stem
from schemas.expressions.tokens import MAX_CONSTANT
from schemas.guesses import KeyPose, PosesGuess
from schemas.mechanisms import Mechanism
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.suggest import did_you_mean
from schemas.values import Bound, Scalar

Numbered = list[tuple[int, Phase]]


def poses(guess: PosesGuess, phases: Numbered, place: tuple[Part, ...]) -> Iterator[Issue]:
    """Times increase; each name is of some planar mechanism's pose, its values constants."""
    users = [(index, phase) for index, phase in phases if isinstance(phase.system, Mechanism)]
    if not users:
        hint = "give 'points', of coordinates, instead"
        yield Issue(pointer(*place), "poses are of planar mechanisms, and here is none", hint)
        return
    ats = [(*place, "poses", index, "at") for index in range(len(guess.poses))]
    for index, (before, after) in enumerate(pairwise(guess.poses), start=1):
        if after.at <= before.at:
            message = f"times increase, but {after.at:g} follows {before.at:g}"
            yield Issue(pointer(*ats[index]), message)
    for index, pose in enumerate(guess.poses):
        if abs(pose.at) > MAX_CONSTANT:
            yield Issue(pointer(*ats[index]), f"a time over {MAX_CONSTANT:g} in size")
        yield from _pose(pose, users, (*place, "poses", index))


def _pose(pose: KeyPose, users: Numbered, place: tuple[Part, ...]) -> Iterator[Issue]:
    known = {name for _, phase in users for name in _positions(phase)}
    for owner, corner in pose.places.items():
        parts: tuple[Part, ...] = (*place, "places", owner)
        if f"{owner}.x" not in known:
            owners = sorted(name[:-2] for name in known if name.endswith(".x"))
            some = "places are of points, contacts, bodies and com: " + ", ".join(owners[:12])
            hint = did_you_mean(owner, owners) or some
            yield Issue(pointer(*parts), f"'{owner}' is no place of the mechanism", hint)
        for number, value in enumerate(corner):
            if value is not None:
                yield from _constant(value, users, (*parts, number))
    for name, bound in pose.values.items():
        parts = (*place, "values", name)
        if name not in known:
            rate = "velocities are those of the lines between the poses" if stem(name)[0] else ""
            hint = did_you_mean(name, sorted(known)) or rate
            yield Issue(pointer(*parts), f"'{name}' is nothing that a pose decides", hint)
        yield from _constant(bound, users, parts)


def _constant(value: Scalar | Bound, users: Numbered, parts: tuple[Part, ...]) -> Iterator[Issue]:
    """What is wrong with a value, over the parameters of the first phase where something is."""
    for index, phase in users:
        constants = Constants.of(phase, ("phases", index))
        constants.issues.clear()  # the parameters' issues are reported by the check of limits
        if isinstance(value, Scalar):
            constants.value(value, parts)
        else:
            constants.interval(value, parts)
        found = list(constants.drain())
        yield from found
        if found:
            return


def _positions(phase: Phase) -> set[str]:
    return phase.system.positions if isinstance(phase.system, Mechanism) else set()
