"""How a solve can end, each end reached by a real problem through the whole pipeline."""

import time
from typing import Any

import pytest

import examples
from schemas.errors import InvalidModel
from schemas.events import EngineEvent, MeshSolved, NlpIteration, StageStarted
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve
from tests.unit.solver.problems import block, solved


def test_converged() -> None:
    solution = solved(block())
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.solver.residuals == []


def test_infeasible_names_the_constraints() -> None:
    """With a force of 3 N at the most the block comes three quarters of the way, to rest."""
    solution = solved(block(phase={"bounds": {"u": [-3, 3]}}))
    assert solution.status is SolutionStatus.LOCALLY_INFEASIBLE
    worst = solution.solver.residuals[0]
    assert (worst.name, worst.phase, worst.time) == ("bound x", "push", 1)
    assert worst.value == pytest.approx(0.25, rel=0.1)
    assert any(worst.name in line for line in solution.advice)


def test_unbounded() -> None:
    document = block(objective={"minimize": "-final.x"})
    del document["phases"][0]["final"]["x"]
    assert solved(document).status is SolutionStatus.UNBOUNDED


def test_the_iteration_limit_returns_the_iterate() -> None:
    solution = solved(block(solver={"max_iterations": 0}))
    assert solution.status is SolutionStatus.ITERATION_LIMIT
    assert solution.certificate.verdict == "not_certified"
    assert solution.phases[0].groups["states"].values["x"][-1] == 1


def test_a_deadline_holds_inside_of_the_solver() -> None:
    document = examples.load("cart_pole") | {"limits": {"seconds": 0.4}, "solver": slow()}
    document["method"] = {"kind": "hermite_simpson", "segments": 2000}
    began = time.monotonic()
    solution = solved(document)
    assert solution.status is SolutionStatus.TIME_LIMIT
    assert time.monotonic() - began < 8  # building 2000 segments and certifying included


def slow() -> dict[str, Any]:
    return {"tolerance": 1.1e-14}


def test_a_stop_returns_the_best_iterate() -> None:
    seen: list[NlpIteration] = []

    def note(event: EngineEvent) -> None:
        if isinstance(event, NlpIteration):
            seen.append(event)

    document = examples.load("cart_pole") | {"refinement": None}
    stopped = solved(document, on_event=note, should_stop=lambda: len(seen) >= 6)
    assert stopped.status is SolutionStatus.CANCELLED
    assert len(seen) == 6
    least = min(seen, key=lambda event: event.violation or 0.0)
    assert stopped.objective == pytest.approx(least.objective)
    assert "best iterate" in stopped.message


def test_a_stop_on_a_later_mesh_keeps_the_solved_one() -> None:
    meshes: list[MeshSolved] = []

    def note(event: EngineEvent) -> None:
        if isinstance(event, MeshSolved):
            meshes.append(event)

    solution = solved(examples.load("cart_pole"), on_event=note, should_stop=lambda: bool(meshes))
    assert solution.status is SolutionStatus.CANCELLED
    assert solution.objective == pytest.approx(58.80542547, abs=1e-6)
    assert len(solution.phases[0].knots) == 26


def test_an_exception_of_a_listener_is_not_swallowed() -> None:
    def fail(event: EngineEvent) -> None:
        if event.type == "nlp_iteration":
            raise LookupError("the listener broke")

    with pytest.raises(LookupError, match="the listener broke"):
        solved(block(), on_event=fail)


def test_a_polynomial_that_rings_fails_its_certificate() -> None:
    document = examples.load("double_integrator")
    document["method"] = {"kind": "chebyshev_lobatto", "degree": 12}
    document["refinement"] = None
    solution = solved(document)
    assert solution.status is SolutionStatus.CERTIFICATE_FAILED
    assert "control overshoot" in solution.message
    assert any("linear" in line for line in solution.advice)


@pytest.mark.parametrize("segments", [9, 10])
@pytest.mark.parametrize("kind", ["hermite_simpson", "radau", "multiple_shooting"])
def test_a_saturated_control_keeps_its_bounds_between_the_nodes(kind: str, segments: int) -> None:
    document = examples.load("double_integrator")
    document["method"] = {"kind": kind, "segments": segments}
    document["refinement"] = None
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED
    assert 2 - 1e-6 < (solution.objective or 0) < 2.05


def test_bends_of_the_control_are_refined_until_the_objective_is_steady() -> None:
    """The dynamics are exact on any mesh: the mesh error sees nothing of the switch."""
    document = examples.load("double_integrator")
    document["method"] = {"kind": "hermite_simpson", "segments": 9, "control": "linear"}
    coarse, fine = (solved(document | {"refinement": how}) for how in (None, {"tolerance": 1e-6}))
    assert (coarse.objective or 0) > 2 + 1e-3
    assert fine.objective == pytest.approx(2, rel=3e-6)
    assert fine.status is SolutionStatus.CONVERGED


def test_the_mesh_limit() -> None:
    document = examples.load("cart_pole")
    document["refinement"] = {"tolerance": 1e-6, "max_segments": 40}
    solution = solved(document)
    assert solution.status is SolutionStatus.MESH_LIMIT
    assert solution.mesh_refinement.iterations[-1].segments == 40
    assert not solution.mesh_refinement.converged


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"system": {"derivatives": {"x": "v", "v": "u/x"}}}, "/phases/0/system/derivatives/v"),
        ({"phase": {"integrals": {"effort": "log(v - 2)"}}}, "/phases/0/integrals/effort"),
        ({"objective": {"minimize": "log(0 - duration)"}}, "/objective/minimize"),
    ],
)
def test_no_number_at_the_guess(change: dict[str, Any], pointer: str) -> None:
    with pytest.raises(InvalidModel) as caught:
        solved(block(**change))
    assert pointer in [issue.pointer for issue in caught.value.issues]
    assert all(issue.hint for issue in caught.value.issues)


def test_a_root_at_its_bound_may_start_there() -> None:
    """IPOPT starts inside of the bounds, where log(v) has a value."""
    document = block(
        phase={
            "bounds": {"v": [0, 5]},
            "initial": {"x": 0},
            "final": {"x": 1},
            "integrals": {"effort": "u^2 - log(v)/100"},
        },
        guess={"kind": "linear"},
    )
    assert solved(document).status in (SolutionStatus.CONVERGED, SolutionStatus.MESH_LIMIT)


def test_free_times() -> None:
    """003, 7.7 in minimum time: T = 2 sqrt(d / u_max), wherever it starts."""
    document = block(
        phase={"time": {"initial": [1, 2], "final": [1, 10]}, "bounds": {"u": [-4, 4]}},
        objective={"minimize": "duration"},
        method={"kind": "trapezoidal", "segments": 200},
    )
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(1.0, abs=1e-3)
    assert 1 <= solution.phases[0].knots[0] <= 2


def test_a_feasible_motion_without_an_objective() -> None:
    document = block()
    del document["objective"]
    assert solved(document).status is SolutionStatus.CONVERGED


def test_no_controls() -> None:
    document = block(
        system={"controls": [], "derivatives": {"x": "v", "v": "-x"}},
        phase={"initial": {"x": 1, "v": 0}, "final": {}, "integrals": {}},
        guess={"kind": "linear"},
    )
    del document["objective"]
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.phases[0].groups["states"].values["x"][-1] == pytest.approx(0.5403023, abs=1e-6)


@pytest.mark.parametrize("form", ["separated", "compressed"])
def test_path_constraints_and_state_bounds_hold(form: str) -> None:
    wall = {"name": "wall", "expression": "x + 0.1*v", "upper": 1.02}
    document = block(
        phase={"path": [wall], "bounds": {"v": [-1, 1.4]}},
        method={"kind": "hermite_simpson", "segments": 40, "form": form},
    )
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(12.563, abs=2e-2)


def test_the_stages_are_told_in_order() -> None:
    stages: list[str] = []

    def note(event: EngineEvent) -> None:
        if isinstance(event, StageStarted):
            stages.append(event.stage)

    solved(block(refinement=None), on_event=note)
    assert stages == ["build", "solve", "refine", "certify"]


def test_snapshots_are_unchecked_solutions() -> None:
    snapshots: list[Solution] = []
    solution = solve(read_problem(examples.load("cart_pole")), on_snapshot=snapshots.append)
    assert len(snapshots) == len(solution.mesh_refinement.iterations)
    assert {snapshot.certificate.verdict for snapshot in snapshots} == {"not_checked"}


def test_warnings_name_what_is_not_smooth() -> None:
    integrals = {"effort": "u^2 + 0*abs(u)"}
    solution = solved(block(phase={"integrals": integrals}))
    assert any("abs" in warning for warning in solution.warnings)


def test_a_long_mesh_shows_its_best_iterate_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.run._PAUSE", 0.0)
    monkeypatch.setattr("solver.run._PAUSES_PER_COST", 0.0)
    snapshots: list[Solution] = []
    document = examples.load("cart_pole") | {"refinement": None}
    solution = solve(read_problem(document), on_snapshot=snapshots.append)
    assert len(snapshots) > 5
    assert {snapshot.status for snapshot in snapshots} == {SolutionStatus.CANCELLED}
    assert [len(snapshot.mesh_refinement.iterations) for snapshot in snapshots[:2]] == [1, 1]
    assert snapshots[-1].objective == solution.objective


def test_a_fast_solve_is_shown_only_when_a_mesh_is_solved() -> None:
    snapshots: list[Solution] = []
    solve(read_problem(block()), on_snapshot=snapshots.append)
    assert len(snapshots) == 1


def test_a_feasible_point_is_never_called_infeasible() -> None:
    """Two rows that are one: the multipliers diverge, but the point meets everything."""
    document = examples.load("double_integrator")
    document["phases"][0]["boundary"] = [
        {"name": "a", "expression": "duration - 2.2", "lower": 0, "upper": 0},
        {"name": "b", "expression": "duration^2 - 4.84", "lower": 0, "upper": 0},
    ]
    solution = solved(document)
    assert solution.certificate.verdict == "certified"
    assert solution.status in (SolutionStatus.CONVERGED, SolutionStatus.ACCEPTABLE)


@pytest.mark.parametrize(
    ("derivative", "initial", "message"),
    [("u + sqrt(x)", 0, "slope"), ("u + atanh(x)", 0.1, "value")],
)
def test_a_model_that_breaks_only_at_an_end(derivative: str, initial: float, message: str) -> None:
    document = block(
        system={"states": ["x"], "derivatives": {"x": derivative}},
        phase={"initial": {"x": initial}, "final": {"x": 5}},
        guess={"kind": "constant", "values": {"x": 0.1}},
    )
    with pytest.raises(InvalidModel) as caught:
        solved(document)
    (issue,) = caught.value.issues
    assert issue.pointer == "/phases/0/system/derivatives/x"
    assert message in issue.message
    assert issue.hint


def test_infeasible_names_the_saturated_controls() -> None:
    solution = solved(block(phase={"bounds": {"u": [-3, 3]}}))
    assert any("'u' is on its bounds" in line for line in solution.advice)


def test_a_duration_that_runs_away_is_told() -> None:
    document = block(phase={"time": {"initial": 0, "final": [0.1, None]}})
    assert any("time.final" in line for line in solved(document).advice)
    bounded = block(phase={"time": {"initial": 0, "final": [0.1, 2]}})
    assert not any("time.final" in line for line in solved(bounded).advice)


def test_where_a_finer_mesh_is_lost_the_optimum_before_it_is_published() -> None:
    """Zermelo's steering angle without bounds: neighbours lie whole turns apart."""
    zermelo = {
        "kind": "ode",
        "states": ["x", "y"],
        "controls": ["a"],
        "derivatives": {"x": "cos(a) - y", "y": "sin(a)"},
    }
    document = block(
        system=zermelo,
        phase={
            "time": {"initial": 0, "final": [0.1, 20]},
            "initial": {"x": 3.66, "y": -1.86},
            "final": {"x": 0, "y": 0},
            "integrals": {},
        },
        objective={"minimize": "duration"},
        guess={"kind": "linear"},
        method={"kind": "hermite_simpson", "segments": 25},
        solver={"max_iterations": 300},
    )
    solution = solved(document)
    assert solution.status is SolutionStatus.MESH_LIMIT
    assert solution.objective == pytest.approx(5.4578, abs=1e-2)
    assert "This is the optimum on" in solution.message
    assert any("whole turns" in line for line in solution.advice)
