"""What the benchmarks through contact count: time an iteration, work from nothing, ratios."""

import math

import numpy as np
import pytest

import examples
from benchmarks.contact_growth import Beat, Point, exponent, measured
from benchmarks.contact_physics import Trial, books, row
from benchmarks.contact_snopt import row as compared
from benchmarks.peers.with_snopt import Timed
from benchmarks.rocker import HALF, RADIUS, rocker
from schemas.events import NlpIteration, StageStarted
from solver.backends import NlpStatus
from solver.backends.ipopt import Ipopt
from tests.backends.tasks import posed, watched
from tests.support.stepped import problem
from tests.support.steps_by_hand import ARM, BLOCK, arm, block
from tests.unit.solver import problems


@pytest.mark.parametrize("contacts", [1, 2, 5, 16])
def test_a_plank_has_as_many_points_on_its_round_side_as_are_asked_for(contacts: int) -> None:
    system = rocker(contacts, 10)["phases"][0]["system"]
    places = np.array([one["at"] for one in system["contacts"].values()])
    assert len(places) == contacts
    assert np.hypot(places[:, 0], places[:, 1] - RADIUS) == pytest.approx(RADIUS)
    assert contacts == 1 or np.ptp(places[:, 0]) == pytest.approx(2 * HALF)


def test_the_median_is_of_the_time_between_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([1.0, 1.5, 1.7, 3.0])
    monkeypatch.setattr("time.process_time", lambda: next(times))
    beat = Beat()
    assert math.isnan(beat.median)
    for number in range(4):
        beat(StageStarted(stage="solve"))
        beat(NlpIteration(mesh=0, iteration=number, objective=0, violation=0, seconds=0))
    assert beat.median == pytest.approx(0.5)


def test_the_exponent_is_that_of_the_large_sizes() -> None:
    points = [Point(n, 9.0 if n < 20 else 1e-3 * n**1.5, 5, 1, 1) for n in (10, 20, 40, 80)]
    assert exponent(points, 20) == pytest.approx(1.5)
    assert math.isnan(exponent(points, 80))


def test_a_plank_is_measured() -> None:
    small, large = (measured(n, rocker(2, n)) for n in (3, 6))
    assert small.seconds > 0
    assert small.iterations > 2
    assert large.variables > 1.5 * small.variables


def test_books_tell_what_the_steps_of_backward_euler_gain() -> None:
    knots, start = np.linspace(0.0, 1.0, 26), np.array([0.9, 0.4, 0.0, -6.0])
    torque = 5 * np.sin(6 * knots[1:])
    posed = problem(ARM, 1.0)
    honest, euler = (books(posed, [arm(knots, start, torque, euler=e)]) for e in (False, True))
    assert honest.gained < 1e-10
    assert euler.gained > 0.01
    assert honest.actuators > 0.1
    assert honest.carried == 0.0


def test_books_tell_what_contacts_give_and_carry() -> None:
    knots, push = np.linspace(0.0, 1.0, 11), np.full(10, 12.0)
    posed, start = problem(BLOCK, 1.0), (0.0, 0.0, 1.0, 0.0)
    rubbed = books(posed, [block(knots, start, push)])
    helped = books(posed, [block(knots, start, push, lambda stop, most: -np.sign(stop) * most)])
    assert rubbed.carried == pytest.approx(1.0)
    assert rubbed.contacts == 0.0
    assert helped.contacts > 1.0


def test_a_row_tells_objective_and_verdict() -> None:
    assert "stiction_block" in examples.names()
    line = row(Trial("stiction_block", 8), "backward_euler")
    assert line.startswith("stiction_block, 8 steps, backward Euler")
    assert line.endswith("certified")
    assert 5 < float(line.split()[5]) < 15


def test_ratios_are_of_all_seconds_and_of_those_without_callbacks() -> None:
    ours = {"status": "converged", "objective": 1.0, "iterations": 9, "seconds": 2.0, "inside": 0.0}
    theirs = ours | {"seconds": 10.0, "inside": 4.0, "objective": None, "status": "time_limit"}
    assert compared("it", theirs, ours).split() == [
        *("it", "-", "9", "10.00", "4.00", "5.0", "3.0", "time_limit")
    ]
    assert compared("it", {"status": "no end"}, ours).split() == ["it", "no", "end"]


def test_a_backend_that_is_timed_adds_up_all_of_its_solves() -> None:
    one, timed = posed(problems.block()), Timed(Ipopt())
    ended = [
        timed.solve(one.task, one.problem.solver, watched(), warm=False).status for _ in range(2)
    ]
    assert ended == [NlpStatus.OPTIMAL] * 2
    first, second = (int(told.split()[1]) for told in timed.passes)
    assert timed.iterations == first + second > 0
    assert timed.seconds > 0
