"""The portfolio: what is tried, when, and what the result says of it."""

from collections.abc import Callable

import numpy as np
import pytest

from schemas.problem import SolverSettings
from solver.backends import Iterate, NlpStatus, Outcome, Strategy, Watch, make_backend
from solver.nlp.task import NlpTask
from solver.solving.portfolio import ELASTIC, Portfolio, Won
from tests.backends.tasks import INFEASIBLE, after, example, posed, run, watched
from tests.unit.solver.problems import block

ADAPTIVE, RESCALED = "adaptive barrier", "rescaled"


def solve(
    task: NlpTask,
    backend: str = "ipopt",
    iterations: int = 300,
    attempt: Callable[[NlpTask, Strategy], Outcome] | None = None,
    watch: Callable[[], Watch] = watched,
) -> tuple[Won, list[str]]:
    """The portfolio after a first attempt that ended at once; what was announced."""
    solver, settings = make_backend(backend), SolverSettings(max_iterations=iterations)

    def plain(task: NlpTask, strategy: Strategy) -> Outcome:
        return solver.solve(task, settings, watch(), warm=False, strategy=strategy)

    heard: list[str] = []
    portfolio = Portfolio(solver, settings, attempt or plain, watch, heard.append)
    return portfolio.solve(task, run(backend, task, iterations=0)), heard


def ended(status: NlpStatus, violation: float, objective: float = 0.0) -> Outcome:
    point = Iterate(np.zeros(1), np.zeros(1), objective, violation)
    return Outcome(status, "", point, 7, 0.0)


def test_the_second_strategy_solves_what_the_first_did_not() -> None:
    won, heard = solve(posed(block()).task)
    assert won.outcome.status is NlpStatus.OPTIMAL
    assert won.outcome.point.objective == pytest.approx(12.0, rel=1e-6)
    assert won.strategy == ADAPTIVE
    assert won.attempts == ("default: iteration limit after 0 iterations",)
    assert heard == [f"again, {ADAPTIVE}"]


def test_a_success_is_left_alone() -> None:
    task = posed(block()).task
    first = run("ipopt", task)
    heard: list[str] = []
    portfolio = Portfolio(
        make_backend("ipopt"), SolverSettings(), lambda *_: first, watched, heard.append
    )
    assert portfolio.solve(task, first).outcome is first
    assert heard == []


def test_the_elastic_start_comes_last_and_solves() -> None:
    task = posed(example("cart_pole", segments=20)).task

    def only_default(tried: NlpTask, strategy: Strategy) -> Outcome:
        if strategy.name != "default":
            return ended(NlpStatus.DIVERGED, 5.0)
        return run("ipopt", tried)

    won, heard = solve(task, attempt=only_default)
    assert heard == [f"again, {name}" for name in (ADAPTIVE, RESCALED, ELASTIC)]
    assert won.strategy == ELASTIC
    assert won.outcome.status is NlpStatus.OPTIMAL
    assert won.outcome.point.violation <= 1e-7
    assert [line.split(":")[0] for line in won.attempts] == ["default", ADAPTIVE, RESCALED]


def test_what_cannot_be_met_stays_infeasible_with_the_least_violation() -> None:
    task = posed(INFEASIBLE).task
    won, _ = solve(task)
    assert won.outcome.status is NlpStatus.INFEASIBLE
    assert len(won.attempts) == 3
    assert won.outcome.point.violation < 0.1


def test_backends_skip_what_they_do_not_know() -> None:
    _, heard = solve(posed(INFEASIBLE).task, backend="uno")
    assert heard == [f"again, {ELASTIC}"]
    _, heard = solve(posed(INFEASIBLE).task, backend="fatrop")
    assert heard == []  # nor has the elastic program an order of stages


@pytest.mark.parametrize("status", [NlpStatus.STOPPED, NlpStatus.TIME_LIMIT])
def test_a_stop_ends_the_portfolio_and_keeps_the_best(status: NlpStatus) -> None:
    task = posed(block()).task
    won, heard = solve(task, attempt=lambda *_: ended(status, 50.0))
    assert heard == [f"again, {ADAPTIVE}"]
    assert won.strategy == "default"
    assert won.outcome.status is status
    assert won.outcome.point.violation < 50.0


def test_a_stop_in_the_elastic_phase() -> None:
    task = posed(example("cart_pole", segments=20)).task
    won, _ = solve(
        task,
        attempt=lambda *_: ended(NlpStatus.DIVERGED, 50.0),
        watch=lambda: watched(should_stop=after(3)),
    )
    assert won.outcome.status is NlpStatus.STOPPED
    assert won.outcome.point.z.shape == task.start.shape


def test_an_acceptable_point_beats_a_lower_one_without_a_claim() -> None:
    ends = {
        ADAPTIVE: ended(NlpStatus.ACCEPTABLE, 0.0, 5.0),
        RESCALED: ended(NlpStatus.ITERATION_LIMIT, 0.0, 4.0),
        "default": ended(NlpStatus.DIVERGED, 9.0),
    }
    won, _ = solve(posed(block()).task, attempt=lambda _, strategy: ends[strategy.name])
    assert won.strategy == ADAPTIVE
    assert won.outcome.status is NlpStatus.ACCEPTABLE


def test_the_default_is_tried_where_another_came_first() -> None:
    task = posed(block()).task
    solver, heard = make_backend("ipopt"), list[str]()
    portfolio = Portfolio(
        solver, SolverSettings(), lambda task, _: run("ipopt", task), watched, heard.append
    )
    won = portfolio.solve(task, run("ipopt", task, iterations=0), Strategy(ADAPTIVE, adaptive=True))
    assert heard == ["again, default"]
    assert won.strategy == "default"
    assert won.attempts == (f"{ADAPTIVE}: iteration limit after 0 iterations",)
