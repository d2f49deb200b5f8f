"""One program: warm or cold, the default strategy or a portfolio, and what the outcome is worth."""

from collections.abc import Callable
from dataclasses import replace

from schemas.errors import InvalidModel, Issue
from schemas.problem import SolverSettings
from solver.backends import DEFAULT, NlpStatus, Outcome, Strategy, Watch, make_backend
from solver.nlp.task import NlpTask
from solver.solving.portfolio import Mask, Portfolio, Won

_OVER = (NlpStatus.OPTIMAL, NlpStatus.STOPPED, NlpStatus.TIME_LIMIT)
_HASTE = 500  # iterations
_NEARLY = (NlpStatus.ACCEPTABLE, NlpStatus.DIVERGED)


def solve_task(
    task: NlpTask,
    settings: SolverSettings,
    watch: Callable[[], Watch],
    announce: Callable[[str], None],
    *,
    warm: bool,
    once: bool = False,
    first: Strategy = DEFAULT,
    limits: tuple[Mask, Mask] | None = None,
) -> Won:
    """Solve; from a warm start first where there is one, and cold again where that fails.

    ``first`` is the strategy to begin with, where the backend knows it.

    ``once``: not again, and not for long; there is an optimum that will do.

    With ``settings.portfolio`` other strategies are tried after a failure; ``limits`` are then the
    rows and variables that are no part of the dynamics. ``announce`` hears of every attempt but
    the first.

    Raises
    ------
    InvalidModel
        If the backend does not take the program.
    """
    backend = make_backend(settings.backend)
    if refusal := backend.refusal(task):
        raise InvalidModel([Issue("/solver/backend", refusal)])

    begin = first if backend.offers(first) else DEFAULT

    def attempt(task: NlpTask, strategy: Strategy = begin, *, warm: bool = False) -> Outcome:
        outcome = backend.solve(task, settings, watch(), warm=warm, strategy=strategy)
        return judged(task, outcome, settings.tolerance)

    if once:
        fewer = min(_HASTE, settings.max_iterations)
        settings = settings.model_copy(update={"max_iterations": fewer, "portfolio": False})
    outcome = attempt(task, warm=warm)
    if warm and not once and outcome.status not in _OVER:
        announce("again, from a cold start")
        again = attempt(task)
        if again.status is NlpStatus.OPTIMAL or outcome.status is not NlpStatus.ACCEPTABLE:
            outcome = again
    if not settings.portfolio:
        return Won(outcome, begin.name)
    portfolio = Portfolio(backend, settings, attempt, watch, announce, limits)
    return portfolio.solve(task, outcome, begin)


def judged(task: NlpTask, outcome: Outcome, tolerance: float) -> Outcome:
    """The outcome, optimal where only round-off kept the solver from saying so."""
    rows, bounds = outcome.row_multipliers, outcome.bound_multipliers
    if outcome.status not in _NEARLY or rows is None or bounds is None:
        return outcome
    if outcome.point.violation > tolerance:
        return outcome
    # Seldom asked, and it loads scipy, which takes longer than most programs to be solved.
    from solver.nlp.stationarity import stationary  # noqa: PLC0415

    arrived = stationary(task, outcome.point.z, rows, bounds, tolerance)
    return replace(outcome, status=NlpStatus.OPTIMAL) if arrived else outcome
