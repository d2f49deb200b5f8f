"""A program with pairs, solved: homotopy, then polish, and what there is to report of both."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from schemas.errors import InvalidModel, Issue
from schemas.methods import Relaxation
from schemas.problem import SolverSettings
from schemas.results import HomotopyPass
from solver.backends import Outcome, Strategy, Watch, make_backend
from solver.complementarity.homotopy import Attempt, Climb, Relaxed, climb
from solver.complementarity.ladder import ADAPTIVE, INEQUALITY, MONOTONE, STEADY, Ladder
from solver.complementarity.pairs import Pairing
from solver.complementarity.pinned import pinned_pairs
from solver.complementarity.polish import Polished
from solver.complementarity.sharpen import sharpened
from solver.nlp.task import NlpTask
from solver.solving.portfolio import Won
from solver.solving.task import judged

_COARSE = 1e-6  # tolerance of a pass, whose solution is only a start
_LONGEST = 1000  # iterations of a pass: then it is lost
_SPARE = 250  # of one that a polish may do without
_STEADY = 200  # of one with a regularised system, which crawls where it does not help

_STRICT = 1e-3  # of a gap of 1 m, a thousandth of the weight: no push from afar

_NEAR = 1e-5  # a relaxation from which a polish may do, where the next pass fails
_FAR = 100.0  # times the relaxation: a product that has nothing to do with it


@dataclass(frozen=True, slots=True)
class PairsWon:
    """The solution of a program with pairs.

    Attributes
    ----------
    won
        As of any program: the polished outcome, or that of the last good pass. Iterations and
        seconds are those of all solves.
    passes
        The passes of the homotopy in order, the failed ones, too.
    polished
        Whether pairs are exact.
    stalled
        Whether the schedule came to no end, so that the point is one of a softer relaxation, or
        whether its end left products far above the relaxation.
    residual
        The largest smaller member of a pair over its size, by the program's own variables.
    product
        The largest product of a pair.
    stationarity
        The label that the polished solve proves.
    pinned
        How many pairs the ends pin.
    strict
        The program with its pairs nearly exact: what to look into where contacts fail.
    """

    won: Won
    form: str
    passes: tuple[HomotopyPass, ...]
    polished: bool
    stalled: bool
    residual: float
    product: float
    stationarity: str | None
    pinned: int
    strict: NlpTask | None = None


def solve_pairs(
    task: NlpTask,
    pairing: Pairing,
    relaxation: Relaxation,
    settings: SolverSettings,
    watch: Callable[[], Watch],
    on_pass: Callable[[HomotopyPass], None],
    *,
    warm: bool = False,
) -> PairsWon:
    """Solve a program whose pair rows are stated in the relaxation's form.

    ``watch`` makes the watch of each solve. ``warm``: the start solves the same problem on
    another mesh; the schedule then begins low.

    Raises
    ------
    InvalidModel
        If the backend does not take the program.
    """
    backend = make_backend(settings.backend)
    if refusal := backend.refusal(task):
        raise InvalidModel([Issue("/solver/backend", refusal)])

    def attempts(longest: int) -> Attempt:
        def attempt(task: NlpTask, strategy: Strategy, *, warm: bool) -> Outcome:
            own = _paced(settings, strategy, longest)
            outcome = backend.solve(task, own, watch(), warm=warm, strategy=strategy)
            return judged(task, outcome, own.tolerance)

        return attempt

    known = tuple(one for one in (MONOTONE, ADAPTIVE) if one is MONOTONE or backend.offers(one))
    relaxed = Relaxed(task, pairing, relaxation.form or "equality", pinned_pairs(task, pairing))
    near = _NEAR if relaxation.polish else 0.0
    ladder = Ladder.of(relaxation, known, warm=warm, steadies=backend.offers(STEADY))
    enough = sum(level > near for level in ladder.levels) + 1
    needed = replace(ladder, levels=ladder.levels[:enough])
    climbed = climb(relaxed, needed, attempts(_LONGEST), on_pass, warm=warm)
    if climbed.reached is not None and climbed.reached <= near and not climbed.over:
        rest = replace(climbed.ladder, levels=ladder.levels[enough:])
        climbed = climb(
            relaxed, rest, attempts(_SPARE), on_pass, warm=True, near=near, before=climbed
        )
    if not relaxation.polish:
        return _told(relaxed, climbed, None)
    return _told(relaxed, *sharpened(relaxed, climbed, attempts, on_pass))


def _paced(settings: SolverSettings, strategy: Strategy, longest: int) -> SolverSettings:
    """The settings of one solve: how long, how tight."""
    tolerance = max(_COARSE, settings.tolerance) if strategy.exact else settings.tolerance
    fewer = min(_STEADY if strategy.steady else longest, settings.max_iterations)
    return settings.model_copy(update={"tolerance": tolerance, "max_iterations": fewer})


def _told(relaxed: Relaxed, climbed: Climb, exact: Polished | None) -> PairsWon:
    outcome = climbed.outcome
    iterations = sum(one.nlp_iterations for one in climbed.passes)
    seconds = sum(one.seconds for one in climbed.passes)
    if exact is not None:
        iterations, seconds = iterations + exact.iterations, seconds + exact.seconds
        outcome = exact.outcome or outcome
        if exact.over is not None:
            outcome = replace(outcome, status=exact.over)
    polished = exact is not None and exact.outcome is not None
    kind = None if exact is None else exact.stationarity
    smaller, product = relaxed.pairing.residuals(outcome.point.z)
    ended = replace(outcome, iterations=iterations, seconds=seconds)
    return PairsWon(
        won=Won(ended, climbed.ladder.strategies[0].name),
        form=climbed.ladder.form,
        passes=climbed.passes,
        polished=polished,
        stalled=not polished and (climbed.stalled or _apart(climbed, product)),
        residual=smaller,
        product=product,
        stationarity=None if kind is None else kind.label,
        pinned=int(relaxed.pinned.sum()),
        strict=relaxed.at(_STRICT, INEQUALITY),
    )


def _apart(climbed: Climb, product: float) -> bool:
    """Whether pairs stay open where all passes were good: only a price can be paid for that."""
    return climbed.reached is not None and product > _FAR * climbed.reached
