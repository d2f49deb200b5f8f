"""Motors, springs and limits of a mechanism: on joints that move, with numbers that can be."""

from collections.abc import Iterator

from schemas.checks.constants import Constants, Interval
from schemas.checks.masses import Numbers
from schemas.errors import Issue
from schemas.mechanisms import (
    Floating,
    Mechanism,
    Motor,
    Prismatic,
    Revolute,
    Spring,
    Welded,
)
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.values import Bound


def check(problem: Problem) -> Iterator[Issue]:
    """Drives of joints without a coordinate, losses that feed energy in, limits of nothing."""
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Mechanism):
            yield from _drives(phase.system, Numbers.of(phase, index))
            yield from _limits(problem, phase, phase.system, index)


def _drives(system: Mechanism, numbers: Numbers) -> Iterator[Issue]:
    for field in ("motors", "springs", "torques"):
        for name, part in getattr(system, field).items():
            joint = system.joints.get(part.joint or "")
            if isinstance(joint, Welded | Floating):
                yield Issue(
                    numbers.at(field, name, "joint"),
                    f"the {joint.kind} joint '{part.joint}' has no coordinate to act on",
                    "act on a revolute or prismatic joint, or use 'forces' on a body",
                )
    for name, motor in system.motors.items():
        yield from _motor(name, motor, numbers)
    for name, spring in system.springs.items():
        yield from _spring(name, spring, numbers)


def _motor(name: str, motor: Motor, numbers: Numbers) -> Iterator[Issue]:
    gear = numbers.value(motor.gear)
    if gear == 0:
        yield Issue(
            numbers.at("motors", name, "gear"),
            "with a gear of 0 the motor does nothing",
            "it is the joint's torque over the motor's; leave it out for 1",
        )
    if motor.losses is None:
        if motor.current is not None:
            yield Issue(
                numbers.at("motors", name, "current"),
                "a motor without 'losses' has no current",
                "limit its 'torque', or give its 'losses'",
            )
        return
    if gear is not None and gear != 1:
        yield Issue(
            numbers.at("motors", name, "gear"),
            "a motor with 'losses' has its gear in their constants",
            "leave 'gear' out and give 'constant' with the gearbox",
        )
    for field in ("constant", "smoothing"):
        value = numbers.value(getattr(motor.losses, field))
        if value is not None and value <= 0:
            yield Issue(numbers.at("motors", name, "losses", field), f"'{field}' must be above 0")
    for field in ("coulomb", "viscous", "friction", "resistance", "brush"):
        value = numbers.value(getattr(motor.losses, field))
        if value is not None and value < 0:
            where = numbers.at("motors", name, "losses", field)
            yield Issue(where, f"'{field}' must not be below 0", "losses take energy")


def _spring(name: str, spring: Spring, numbers: Numbers) -> Iterator[Issue]:
    for field in ("stiffness", "damping"):
        value = numbers.value(getattr(spring, field))
        if value is not None and value < 0:
            yield Issue(
                numbers.at("springs", name, field),
                f"the {field} of '{name}' is {value:g}, and must not be below 0",
                "a negative one would feed energy in; use 'torques' or 'forces' for that",
            )


def _limits(problem: Problem, phase: Phase, system: Mechanism, index: int) -> Iterator[Issue]:
    """Limits of joints and motors: evaluable, in order, and together with 'bounds' possible."""
    root: tuple[Part, ...] = ("phases", index)
    constants = Constants.of(phase, root, problem.static)
    constants.issues.clear()
    for parts, limit in _pairs(system):
        if limit.fixed and limit.lower is not None:
            value = limit.lower.dump()
            yield Issue(
                pointer(*root, "system", *parts),
                f"'{parts[-1]}' is a pair, [lower, upper]; a number alone would fix it",
                f"write [-{value}, {value}]" if isinstance(value, float) and value > 0 else "",
            )
    for name, joint in system.joints.items():
        if isinstance(joint, Revolute | Prismatic) and joint.limits is not None:
            place = (*root, "system", "joints", name, "limits")
            interval = constants.interval(joint.limits, place)
            fields = ("bounds", "initial", "final")
            bounds = {field: getattr(phase, field).get(name) for field in fields}
            given = {
                field: constants.interval(bound, (*root, field, name))
                for field, bound in bounds.items()
                if bound is not None
            }
            constants.issues = [one for one in constants.issues if "/system/" in one.pointer]
            yield from constants.drain()
            for field, pair in given.items():
                if interval and pair and (pair[0] > interval[1] or pair[1] < interval[0]):
                    yield _beyond(name, field, pair, interval, root)
    for parts, limit in _pairs(system):
        if parts[0] == "motors":
            constants.interval(limit, (*root, "system", *parts))
    yield from constants.drain()


def _beyond(
    name: str, field: str, given: Interval, limits: Interval, root: tuple[Part, ...]
) -> Issue:
    """What bounds or ends say of a joint lies outside of its limits."""
    if field == "bounds":
        return Issue(
            pointer(*root, field, name),
            f"no value of '{name}' keeps both these bounds and the joint's own limits",
            "widen one of them; both hold",
        )
    near, side, by = given[0], limits[1], given[0] - limits[1]
    if by < 0:
        near, side, by = given[1], limits[0], limits[0] - given[1]
    return Issue(
        pointer(*root, field, name),
        f"{near:.6g} is {by:.4g} beyond the limit of the joint '{name}', {side:.6g}",
        f"the nearest is {side:.6g} (angles are in rad); or widen the joint's 'limits'",
    )


def _pairs(system: Mechanism) -> Iterator[tuple[tuple[Part, ...], Bound]]:
    """The limits of joints and motors, and where they stand."""
    for name, joint in system.joints.items():
        if isinstance(joint, Revolute | Prismatic) and joint.limits is not None:
            yield ("joints", name, "limits"), joint.limits
    for name, motor in system.motors.items():
        for field in ("torque", "speed", "power", "current"):
            if getattr(motor, field) is not None:
                yield ("motors", name, field), getattr(motor, field)
