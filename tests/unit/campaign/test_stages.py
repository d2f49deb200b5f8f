"""Stages are solved in a row, each from the solution of the one before."""

import pytest

from footfall.curves import Curves
from schemas.guesses import LinearGuess, SolutionGuess
from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import Solution, SolutionStatus
from schemas.stages import halfway
from solver.campaign import solve_stages
from solver.run import Run
from tests.unit.campaign.problems import Recorder, read

ABOVE = {"kind": "points", "time": [0, 0.5, 1], "values": {"y": [0, 0.5, 0]}}


def test_without_stages_it_is_the_problem_itself() -> None:
    record = Recorder()
    solution = solve_stages(read(), record.solve, record.run)
    assert record.problems == [read()]
    assert solution.stages == []


def test_each_stage_starts_from_the_one_before() -> None:
    grown = [{"phases": {"walk": {"system": {"parameters": {"r": r}}}}} for r in (0.2, 0.3)]
    record = Recorder()
    posed = read(guess=ABOVE, stages=grown)
    solution = solve_stages(posed, record.solve, record.run)
    first, second = record.problems
    assert first.guess == posed.guess
    assert isinstance(second.guess, SolutionGuess)
    assert [problem.stages for problem in record.problems] == [[], []]
    assert [problem.phases[0].system.parameters["r"].source for problem in (first, second)] == [
        0.2,
        0.3,
    ]
    y = Curves.from_dict(solution.phases[0].curves["states"].model_dump())["y"]
    assert y(0.5) > 0.3, "the way above is kept, though the one below is shorter"
    assert second.guess.phases[0].curves != solution.phases[0].curves


def test_the_result_reports_on_all_stages() -> None:
    record = Recorder()
    posed = read(
        stages=[
            {"objective": {"minimize": "0"}},
            {"objective": {"minimize": "effort"}},
            {"method": {"segments": 20}},
        ]
    )
    solution = solve_stages(posed, record.solve, record.run)
    assert [report.status for report in solution.stages] == [SolutionStatus.CONVERGED] * 3
    assert [report.segments for report in solution.stages] == [12, 12, 20]
    assert solution.stages[0].objective == 0
    assert solution.stages[-1].objective == solution.objective
    assert solution.reproduce.spec_sha256 == spec_sha256(posed)
    assert record.notes == ["stage 1 of 3", "stage 2 of 3", "stage 3 of 3"]
    assert sum(report.seconds for report in solution.stages) <= solution.timing.total + 0.05


def test_a_stage_that_fails_ends_the_row() -> None:
    record = Recorder()
    posed = read(
        stages=[
            {},
            {"phases": {"walk": {"bounds": {"u": [-5, 0.5]}}}},
            {"phases": {"walk": {"bounds": {"u": [-5, 5]}}}},
        ]
    )
    solution = solve_stages(posed, record.solve, record.run)
    assert solution.status is SolutionStatus.LOCALLY_INFEASIBLE
    assert [report.status for report in solution.stages] == [
        SolutionStatus.CONVERGED,
        SolutionStatus.LOCALLY_INFEASIBLE,
    ]
    assert solution.message.startswith("Stage 2 of 3: ")
    assert solution.message.endswith("The stages after it were not solved.")


def test_the_last_one_is_told_when_it_fails() -> None:
    record = Recorder()
    posed = read(stages=[{}, {"phases": {"walk": {"bounds": {"u": [-5, 0.5]}}}}])
    solution = solve_stages(posed, record.solve, record.run)
    assert solution.message.startswith("Stage 2 of 2: ")
    assert "not solved" not in solution.message


def test_a_stop_ends_the_row() -> None:
    record = Recorder()
    record.stop = True
    solution = solve_stages(read(stages=[{}, {}]), record.solve, record.run)
    assert len(solution.stages) == 1
    assert solution.status is SolutionStatus.CANCELLED


def test_statics_go_from_stage_to_stage() -> None:
    record = Recorder()
    posed = read(
        static={"gain": {"bounds": [0.5, 2]}},
        objective={"minimize": "effort + (gain - 1.25)^2"},
        stages=[{}, {}],
    )
    solution = solve_stages(posed, record.solve, record.run)
    guess = record.problems[1].guess
    assert not isinstance(guess, LinearGuess)
    assert isinstance(guess, SolutionGuess)
    assert guess.static["gain"] == pytest.approx(1.25, abs=1e-5)
    assert solution.static["gain"] == pytest.approx(1.25, abs=1e-5)


def test_the_way_to_a_stage_that_fails_is_halved() -> None:
    """A stage that ends early from far away, and well from halfway."""
    record = Recorder()

    def near(problem: Problem, run: Run) -> Solution:
        solution = record.solve(problem, run)
        speeds = [one.phases[0].system.parameters["r"].source for one in record.problems[-2:]]
        if len(speeds) == 2 and abs(float(str(speeds[1])) - float(str(speeds[0]))) > 0.06:
            failed = {"status": SolutionStatus.ITERATION_LIMIT}
            record.problems.pop()  # the next one starts from the last good one
            return solution.model_copy(update=failed)
        return solution

    grown = [{"phases": {"walk": {"system": {"parameters": {"r": r}}}}} for r in (0.2, 0.3)]
    solution = solve_stages(read(stages=grown, halvings=2), near, record.run)
    radii = [one.phases[0].system.parameters["r"].source for one in record.problems]
    assert radii == pytest.approx([0.2, 0.25, 0.3])
    assert [report.status for report in solution.stages] == [
        SolutionStatus.CONVERGED,
        SolutionStatus.ITERATION_LIMIT,
        SolutionStatus.CONVERGED,
        SolutionStatus.CONVERGED,
    ]
    assert "half of the way" in record.notes


def test_what_has_no_numbers_in_between_is_not_halved() -> None:
    record = Recorder()
    posed = read(stages=[{}, {"phases": {"walk": {"bounds": {"u": [-5, 0.5]}}}}])
    assert len(solve_stages(posed, record.solve, record.run).stages) == 2
    assert halfway(posed, posed) is None
