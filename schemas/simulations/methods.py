"""Numbers of a simulation's method, and what its grounds must not be for it."""

import math
from collections.abc import Iterator

from schemas import resolve
from schemas.checks.contacts import kinked
from schemas.errors import Issue
from schemas.expressions import ExpressionError
from schemas.limits import MODEL_LIMITS
from schemas.mechanisms import Mechanism
from schemas.pointers import pointer
from schemas.simulations.document import Events, Simulation, Smooth, TimeStepping
from schemas.values import Scalar


def check_method(simulation: Simulation) -> Iterator[Issue]:
    """What is wrong with a method where all else is right."""
    yield from _grounds(simulation)
    yield from _restitution(simulation)
    yield from _steps(simulation)


def _grounds(simulation: Simulation) -> Iterator[Issue]:
    """What holds contacts by their accelerations would lose them at a kink of the ground."""
    system = simulation.system
    if isinstance(system, Mechanism) and isinstance(simulation.method, Events):
        touched = {pair.against for pair in system.touching.values()}
        for name, surface in system.surfaces.items():
            if name in touched:
                yield from kinked(name, surface, ("system",))


def _restitution(simulation: Simulation) -> Iterator[Issue]:
    method, place = simulation.method, pointer("method", "restitution")
    if isinstance(method, Smooth) or method.restitution is None:
        return
    try:
        bounce = _value(simulation, method.restitution)
    except ExpressionError as error:
        yield Issue(place, error.message, error.hint, error.column)
        return
    if not 0 <= bounce <= 1:
        yield Issue(
            place,
            f"a coefficient of restitution of {bounce:g}",
            "it is from 0, where nothing bounces, to 1, where no energy is lost",
        )


def _steps(simulation: Simulation) -> Iterator[Issue]:
    """More steps than there may be; a duration without value is named elsewhere."""
    method = simulation.method
    if not isinstance(method, TimeStepping):
        return
    duration = _value(simulation, simulation.duration)
    most = MODEL_LIMITS.simulation_steps
    if math.ceil(duration / method.step * (1 - 1e-12)) > most:
        yield Issue(
            pointer("method", "step"),
            f"{duration:g} s are more than {most} steps of {method.step:g} s",
            f"take steps of {duration / most:.3g} s or more, or a shorter duration",
        )


def _value(simulation: Simulation, given: Scalar) -> float:
    """The number of a scalar. Raises ExpressionError where it has none."""
    fixed = {name: resolve.scalar(one, {}) for name, one in simulation.static.items()}
    return resolve.scalar(given, {**fixed, **resolve.parameters(simulation.system)})
