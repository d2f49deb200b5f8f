"""Many guesses: the best is published, and what is different is told apart."""

import pytest

from footfall.curves import Curves
from schemas.guesses import LinearGuess, RandomGuess
from schemas.reading import spec_sha256
from schemas.results import Minimum, Solution, SolutionStatus
from solver.campaign import distinct, solve_guesses, solve_stages
from solver.campaign.multistart import started
from tests.unit.campaign.problems import Recorder, read


def height(phases: Solution | Minimum) -> float:
    """On which side of the disc a motion passes."""
    curves = Curves.from_dict(phases.phases[0].curves["states"].model_dump())
    return float(curves["y"](0.5))


def solved(count: int, **changes: object) -> tuple[Solution, Recorder]:
    record = Recorder()
    return solve_guesses(read(multistart=count, **changes), record.solve, record.run), record


def test_one_guess_is_the_problem_itself() -> None:
    solution, record = solved(1)
    assert len(record.problems) == 1
    assert solution.minima == []


def test_both_ways_around_are_found_and_the_shorter_is_published() -> None:
    solution, record = solved(8, guess={"kind": "random", "seed": 3, "spread": 0.5})
    below, above = solution.minima
    assert height(below) == pytest.approx(-0.2, abs=0.02)
    assert height(above) == pytest.approx(0.4, abs=0.02)
    assert below.objective is not None
    assert above.objective is not None
    assert below.objective < above.objective
    assert solution.objective == pytest.approx(below.objective, rel=1e-6)
    assert height(solution) < 0
    assert sorted([*below.seeds, *above.seeds]) == list(range(3, 11))
    assert [
        problem.guess.seed for problem in record.problems if isinstance(problem.guess, RandomGuess)
    ] == list(range(3, 11))
    assert solution.reproduce.spec_sha256 == spec_sha256(
        read(multistart=8, guess={"kind": "random", "seed": 3, "spread": 0.5})
    )
    assert solution.reproduce.seed in below.seeds
    assert record.notes[:2] == ["guess 1 of 8", "guess 2 of 8"]


def test_the_first_guess_is_the_problems_own() -> None:
    posed = read(multistart=3, guess={"kind": "linear", "duration": 2.0})
    guesses = [started(posed, number) for number in range(3)]
    assert [seed for seed, _ in guesses] == [0, 1, 2]
    assert isinstance(guesses[0][1].guess, LinearGuess)
    for seed, problem in guesses[1:]:
        assert problem.guess == RandomGuess(kind="random", seed=seed, duration=2.0)


def test_guesses_of_phases_vary_too() -> None:
    posed = read(multistart=2)
    own = posed.phases[0].model_copy(update={"guess": RandomGuess(kind="random", seed=40)})
    _, second = started(posed.model_copy(update={"phases": [own]}), 1)
    assert second.phases[0].guess == RandomGuess(kind="random", seed=41)


def test_guesses_that_lead_nowhere_are_counted() -> None:
    solution, _ = solved(3, solver={"max_iterations": 2})
    assert solution.minima == []
    assert solution.status is SolutionStatus.ITERATION_LIMIT
    assert "0 of 3 guesses led to a motion." in solution.warnings


def test_where_all_lead_somewhere_there_is_no_warning() -> None:
    solution, _ = solved(2)
    assert solution.warnings == []


def test_the_time_is_shared() -> None:
    _, record = solved(3)
    assert record.deadlines[0] == pytest.approx(20, abs=1)
    assert record.deadlines[1] == pytest.approx(30, abs=1)
    assert record.deadlines[2] == pytest.approx(60, abs=2)


def test_a_stop_ends_the_search() -> None:
    record = Recorder()
    record.stop = True
    solution = solve_guesses(read(multistart=5), record.solve, record.run)
    assert len(record.problems) == 1
    assert solution.status is SolutionStatus.CANCELLED
    assert "4 guesses were not tried: no time was left." in solution.warnings


def test_guesses_may_have_stages() -> None:
    record = Recorder()
    posed = read(
        multistart=2,
        stages=[{"objective": {"minimize": "0"}}, {"objective": {"minimize": "effort"}}],
    )
    solution = solve_guesses(
        posed, lambda problem, run: solve_stages(problem, record.solve, run), record.run
    )
    assert len(record.problems) == 4
    assert len(solution.stages) == 2


def test_one_motion_on_two_meshes_is_one_minimum() -> None:
    record = Recorder()
    fine = {"kind": "hermite_simpson", "segments": 24, "control": "linear"}
    smooth = {"phases": [read().phases[0].model_dump(mode="json") | {"path": []}]}
    one, two = (
        record.solve(read(**smooth, **method), record.run) for method in ({}, {"method": fine})
    )
    (minimum,) = distinct([(7, one), (2, two)])
    assert minimum.seeds == [2, 7]


def test_equal_objectives_are_no_equal_motions() -> None:
    record = Recorder()
    phase = read().phases[0].model_dump(mode="json")
    phase["path"][0]["expression"] = "(x - 0.5)^2 + y^2 - r^2"
    ways = [
        record.solve(
            read(
                phases=[phase],
                guess={"kind": "points", "time": [0, 0.5, 1], "values": {"y": [0, side, 0]}},
            ),
            record.run,
        )
        for side in (-0.5, 0.5)
    ]
    assert ways[0].objective == pytest.approx(ways[1].objective, rel=1e-7)
    assert len(distinct(enumerate(ways))) == 2
