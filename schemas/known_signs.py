"""What bounds and constants say about the signs of a problem's names."""

from collections.abc import Mapping

from schemas.expressions import ExpressionError
from schemas.expressions.signs import Sign, sign_of, sign_of_interval, sign_of_number
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.resolve import interval, parameters
from schemas.values import Bound


class KnownSigns:
    """Signs of names along the phases and at their ends, of a problem that can be evaluated.

    What cannot be evaluated has no known sign; other checks say so.
    """

    def __init__(self, problem: Problem) -> None:
        self._phases = {phase.name: phase for phase in problem.phases}
        self._along = {phase.name: _along(problem, phase) for phase in problem.phases}
        self._only = problem.phases[0] if len(problem.phases) == 1 else None

    def along(self, phase: Phase, name: str) -> Sign:
        """The sign of a series, an intermediate, a constant or an integral of a phase."""
        return self._along[phase.name].get(name)

    def at_ends(self, phase: Phase | None, name: str) -> Sign:
        """The sign of a name as boundary constraints of ``phase`` see it; None: as the problem."""
        head, _, rest = name.partition(".")
        if phase is None and head in self._phases:
            return self.at_ends(self._phases[head], rest)
        phase = phase or self._only
        if phase is None:
            return next(iter(self._along.values())).get(name)
        if name == "duration":
            return 1
        if head not in ("initial", "final"):
            return self.along(phase, name)
        given: Mapping[str, Bound] = phase.initial if head == "initial" else phase.final
        here = _sign(given.get(rest), _constants(phase))
        return self.along(phase, rest) if here is None else here


def _along(problem: Problem, phase: Phase) -> dict[str, Sign]:
    constants = _constants(phase)
    signs: dict[str, Sign] = {name: sign_of_number(value) for name, value in constants.items()}
    signs |= {name: _sign(static.bounds, {}) for name, static in problem.static.items()}
    signs |= {name: _sign(bound, constants) for name, bound in phase.bounds.items()}
    for name, expression in (phase.system.define | phase.integrals).items():
        if signs.get(name) is None:
            signs[name] = sign_of(expression.tree, signs.get)
    return signs


def _constants(phase: Phase) -> dict[str, float]:
    try:
        return parameters(phase.system)
    except ExpressionError:
        return {}


def _sign(bound: Bound | None, constants: Mapping[str, float]) -> Sign:
    try:
        return sign_of_interval(*interval(bound, constants))
    except ExpressionError:
        return None
