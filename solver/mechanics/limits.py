"""The limits of joints and motors as bounds of their phases: all that reads bounds sees them."""

import math
from collections.abc import Iterator, Mapping

from schemas import resolve
from schemas.expressions import Call, Expression, ExpressionError, Name, constant
from schemas.mechanisms import Mechanism, Motor, Prismatic, Revolute, motor_control
from schemas.phases import Constraint, Phase
from schemas.problem import Problem
from schemas.urdf import Urdf
from schemas.values import Bound, Scalar

Limits = tuple[float, float]


def limited(problem: Problem) -> Problem:
    """The problem with the limits of its mechanisms' joints and motors among bounds and path rows.

    Where the user bounds the same name, the tighter limits hold.
    """
    if not any(isinstance(phase.system, Mechanism | Urdf) for phase in problem.phases):
        return problem
    return problem.model_copy(update={"phases": [_limited(phase) for phase in problem.phases]})


def _limited(phase: Phase) -> Phase:
    system = phase.system
    if not isinstance(system, Mechanism | Urdf):
        return phase
    constants = resolve.parameters(system)
    bounds, path = dict(phase.bounds), list(phase.path)
    for name, limits in _own(system, constants):
        bounds[name] = _tighter(bounds.get(name), limits, constants)
    for name, motor in system.motors.items() if isinstance(system, Mechanism) else ():
        row = _geared(name, motor, constants)
        path += [row] if row is not None else []
    return phase.model_copy(update={"bounds": bounds, "path": path})


def _own(system: Mechanism | Urdf, constants: Mapping[str, float]) -> Iterator[tuple[str, Limits]]:
    """Names and their limits."""
    if isinstance(system, Urdf):
        pushing = system.define  # stops that push are no bounds (``solver.contact``)
        yield from (own for own in system.intervals.items() if f"limit.{own[0]}" not in pushing)
        return
    for name, joint in system.joints.items():
        if isinstance(joint, Revolute | Prismatic) and joint.limits is not None:
            yield name, resolve.interval(joint.limits, constants)
    for name, motor in system.motors.items():
        for word in ("speed", "power"):
            if getattr(motor, word) is not None:
                yield f"motor.{name}.{word}", resolve.interval(getattr(motor, word), constants)
        if motor.current is not None:
            yield motor_control(name, motor), resolve.interval(motor.current, constants)
        gear = _gear(motor, constants)
        if motor.torque is not None and gear is not None:
            sides = sorted(side / gear for side in resolve.interval(motor.torque, constants))
            yield f"motor.{name}.torque", (sides[0], sides[1])


def _gear(motor: Motor, constants: Mapping[str, float]) -> float | None:
    """A gear that is known before the solve; that of motors with losses is in their constants."""
    try:
        return 1.0 if motor.losses else constant(motor.gear.tree, constants)
    except ExpressionError:
        return None


def _geared(name: str, motor: Motor, constants: Mapping[str, float]) -> Constraint | None:
    """The limits of a torque whose gear the solver chooses."""
    if motor.torque is None or _gear(motor, constants) is not None:
        return None
    control = Name(motor_control(name, motor))
    effort = Expression(f"({motor.gear}) * {control.name}", Call("*", (motor.gear.tree, control)))
    lower, upper = (_side(side) for side in resolve.interval(motor.torque, constants))
    return Constraint.model_construct(
        name=f"motor {name} torque", expression=effort, lower=lower, upper=upper
    )


def both(
    given: Mapping[str, Bound], others: Mapping[str, Bound], constants: Mapping[str, float]
) -> dict[str, Bound]:
    """Bounds of both; where both bound a name, the tighter limits hold."""
    met = {
        name: _tighter(given.get(name), resolve.interval(bound, constants), constants)
        for name, bound in others.items()
    }
    return {**given, **met}


def _tighter(given: Bound | None, limits: Limits, constants: Mapping[str, float]) -> Bound:
    lower, upper = resolve.interval(given, constants)
    return Bound(_side(max(lower, limits[0])), _side(min(upper, limits[1])))


def _side(value: float) -> Scalar | None:
    return Scalar(value) if math.isfinite(value) else None
