"""The homotopy's recovery, told what succeeds and what fails."""

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np
import pytest

from schemas.methods import Relaxation
from schemas.problem import SolverSettings
from schemas.results import HomotopyPass
from solver.backends import NlpStatus, Outcome, Strategy, make_backend
from solver.backends.plugin import iterate_at
from solver.complementarity.homotopy import Climb, Relaxed, climb, resumed
from solver.complementarity.ladder import ADAPTIVE, INEQUALITY, MONOTONE, Ladder
from solver.nlp.task import NlpTask
from tests.unit.complementarity.programs import pair, stated, watched

POSED = stated({"x": (0.5, 0.0, inf), "y": (0.4, 0.0, inf)}, "(x-1)^2 + (y-1)^2", [pair("x", "y")])
COLUMN = POSED.pairing.column


class Told:
    """An attempt that solves nothing: whether it is good is asked of eps, form and strategy."""

    def __init__(self, good: Callable[[float, str, Strategy], bool]) -> None:
        self.good = good
        self.begun: list[tuple[NlpTask, bool]] = []

    def __call__(self, task: NlpTask, strategy: Strategy, *, warm: bool) -> Outcome:
        self.begun.append((task, warm))
        eps = float(task.lower[COLUMN])
        row = POSED.pairing.rows[0]
        form = "equality" if task.row_lower[row] == task.row_upper[row] else "inequality"
        side = np.sqrt(eps)
        point = replace(iterate_at(task, np.array([side, side, eps])), violation=0.0)
        status = NlpStatus.OPTIMAL if self.good(eps, form, strategy) else NlpStatus.DIVERGED
        return Outcome(status, "", point, 1, 0.0, np.array([eps]), np.zeros(3))


def climbed(
    schedule: list[float], attempt: Told, *, warm: bool = False
) -> tuple[Climb, list[tuple[float, str]]]:
    passes: list[HomotopyPass] = []
    ladder = Ladder.of(Relaxation(schedule=schedule), (MONOTONE, ADAPTIVE), warm=warm)
    relaxed = Relaxed(POSED.task, POSED.pairing, "equality", np.array([False]))
    found = climb(relaxed, ladder, attempt, passes.append, warm=warm)
    assert found.passes == tuple(passes)
    return found, [(one.relaxation, one.form) for one in passes]


def test_each_pass_begins_where_the_last_one_ended() -> None:
    attempt = Told(lambda *_: True)
    found, _ = climbed([1.0, 0.25], attempt)
    (first, cold), (second, warm) = attempt.begun
    assert (cold, warm) == (False, True)
    assert first.row_multipliers is None
    assert second.start.tolist() == [1.0, 1.0, 0.25]
    assert second.row_multipliers is not None
    assert second.row_multipliers.tolist() == [1.0]
    assert found.reached == 0.25
    assert not found.stalled


def test_a_pass_that_fails_goes_back_and_halves_the_way() -> None:
    last = [1.0]

    def good(eps: float, *_: object) -> bool:
        near = eps >= last[0] / 20
        last[0] = eps if near else last[0]
        return near

    attempt = Told(good)
    found, passes = climbed([1.0, 1e-2, 1e-3], attempt)
    assert [eps for eps, _ in passes] == pytest.approx([1.0, 1e-2, 1e-1, 1e-2, 1e-3])
    assert attempt.begun[2][0].start[:2].tolist() == [1.0, 1.0]  # of the last good pass
    assert not found.stalled


def test_a_first_pass_that_fails_begins_softer_and_with_an_adaptive_barrier() -> None:
    seen: list[Strategy] = []

    def good(_: float, __: str, strategy: Strategy) -> bool:
        seen.append(strategy)
        return strategy.adaptive

    _, passes = climbed([1.0, 0.1], Told(good))
    assert [eps for eps, _ in passes] == [1.0, 10.0, 1.0, 0.1]
    assert seen == [MONOTONE, ADAPTIVE, ADAPTIVE, ADAPTIVE]


def test_without_an_adaptive_barrier_the_first_pass_begins_softer_all_the_same() -> None:
    ladder = Ladder((1.0, 0.1), "equality", (MONOTONE,)).back()
    assert ladder is not None
    assert ladder.levels == (10.0, 1.0, 0.1)
    assert ladder.strategy == MONOTONE


def test_then_the_inequality_takes_over_and_stays() -> None:
    found, passes = climbed(
        [1.0, 1e-2, 1e-3], Told(lambda eps, form, _: eps > 0.5 or form[0] == "i")
    )
    assert passes[-2:] == [(1e-2, "inequality"), (1e-3, "inequality")]
    assert not found.stalled


def test_where_nothing_helps_it_ends_with_the_last_good_point() -> None:
    found, passes = climbed([1.0, 1e-2, 1e-3], Told(lambda eps, *_: eps > 0.9))
    assert found.stalled
    assert found.reached == 1.0
    assert found.outcome.point.z.tolist() == [1.0, 1.0, 1.0]
    assert len(passes) < 20


def test_where_nothing_is_ever_good_it_ends_with_the_last_failure() -> None:
    found, passes = climbed([1.0, 1e-2], Told(lambda *_: False))
    assert not found.stalled
    assert found.reached is None
    assert found.outcome.status is NlpStatus.DIVERGED
    assert len(passes) < 10


def test_a_regularised_system_is_the_last_thing_that_is_tried() -> None:
    """It crawls where it does not help: smaller steps and inequalities are cheaper."""
    ladder = Ladder((1e-1, 1e-2, 1e-3), "equality", (MONOTONE,), steadies=True).on()
    tried = []
    while (failed := ladder.back()) is not None:
        tried.append(failed)
        ladder = failed
    levels = [one.levels[0] for one in tried]
    assert levels[0] == pytest.approx(10**-1.5)
    assert [one.form for one in tried] == sorted(one.form for one in tried)
    steady = [one.strategy.steady for one in tried]
    assert steady == sorted(steady)
    assert steady.count(True) == 1
    assert tried[-1].strategy.exact


def test_a_regularised_system_that_helps_is_kept() -> None:
    ladder = Ladder((1e-2,), INEQUALITY, (MONOTONE,), reached=1e-2, tries=9, steadies=True)
    failed = ladder.back()
    assert failed is not None
    assert failed.on().strategy.steady


def test_further_is_below_what_was_reached() -> None:
    ladder = Ladder((1e-5,), "equality", (MONOTONE,)).on().further()
    assert ladder.levels == pytest.approx((1e-6, 1e-7))


def test_it_pauses_where_a_polish_may_do_and_goes_on_from_there() -> None:
    attempt = Told(lambda eps, *_: eps > 0.9e-2)
    ladder = Ladder.of(Relaxation(schedule=[1.0, 1e-2, 1e-3]), (MONOTONE,), warm=False)
    relaxed = Relaxed(POSED.task, POSED.pairing, "equality", np.array([False]))
    found = climb(relaxed, ladder, attempt, lambda _: None, warm=False, near=1e-2)
    assert found.paused
    assert found.reached == 1e-2
    assert len(found.passes) == 3
    attempt.good = lambda *_: True
    rest = climb(relaxed, found.ladder, attempt, lambda _: None, warm=False, near=0.0, before=found)
    assert not rest.paused
    assert rest.reached == 1e-3
    assert rest.passes[:3] == found.passes
    assert attempt.begun[3][0].start[:2] == pytest.approx([0.1, 0.1])  # of the good pass


def test_a_start_from_another_mesh_begins_low() -> None:
    attempt = Told(lambda *_: True)
    _, passes = climbed([1.0, 1e-2, 1e-3, 1e-5], attempt, warm=True)
    assert [eps for eps, _ in passes] == [1e-3, 1e-5]
    assert attempt.begun[0][1]
    _, passes = climbed([1.0, 1e-2], Told(lambda *_: True), warm=True)
    assert [eps for eps, _ in passes] == [1e-2]


def test_a_start_with_multipliers_is_where_it_was_solved() -> None:
    """Without them the solver has to find the multipliers anew, from further inside."""
    task = Relaxed(POSED.task, POSED.pairing, "equality", np.array([False])).at(1e-3, "equality")
    backend, settings = make_backend("ipopt"), SolverSettings()
    first = backend.solve(task, settings, watched(), warm=False)
    again = backend.solve(resumed(task, first), settings, watched(), warm=True)
    assert first.status is again.status is NlpStatus.OPTIMAL
    assert again.iterations <= 2 < first.iterations
    assert again.point.z == pytest.approx(first.point.z, abs=1e-7)
