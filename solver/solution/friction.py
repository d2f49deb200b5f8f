"""Where friction is what is missing: which contact, how much, and what it has."""

from collections.abc import Iterator, Sequence

from schemas import resolve
from schemas.expressions import ExpressionError, constant
from schemas.mechanisms import Mechanism
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.results import Residual
from schemas.urdf import Urdf
from solver.hybrid.modes import friction

_PATH, _CONE = "path ", " cone"


def friction_advice(problem: Problem, residuals: Sequence[Residual]) -> Iterator[str]:
    """A line for each contact whose friction cone has to give way, the worst time of each."""
    told: set[tuple[str | None, str]] = set()
    for row in residuals:
        pair = row.name.removeprefix(_PATH).removesuffix(_CONE)
        if row.name != f"{_PATH}{pair}{_CONE}" or (row.phase, pair) in told:
            continue
        told.add((row.phase, pair))
        phase = next((one for one in problem.phases if one.name == row.phase), problem.phases[0])
        has = _coefficient(phase, pair)
        if has is not None and row.value is not None:
            when = "" if row.time is None else f" at t = {row.time:.4g} s"
            yield (
                f"With more friction at '{pair}' the rest could be met: with {has:g}, "
                f"{abs(row.value):.3g} N along the ground are missing{when}."
            )


def _coefficient(phase: Phase, pair: str) -> float | None:
    system = phase.system
    if not isinstance(system, Mechanism | Urdf) or pair not in system.touching:
        return None
    given = friction(system, pair) if isinstance(system, Mechanism) else system.ground.friction
    try:
        return constant(given.tree, resolve.parameters(system))
    except ExpressionError:  # the solver chooses it
        return None
