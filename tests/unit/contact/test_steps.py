"""Time steps through contact: what is solved, and what users see of it."""

import numpy as np
import pytest

from schemas.errors import BadProblem
from schemas.results import SolutionStatus
from solver import solve
from solver.contact import as_stepped, contacts_of
from solver.contact.changes import changes
from solver.posing import Posing
from tests.support.pushed_block import EFFORT, pushed_block, reread
from tests.support.stepped import published

WAYS = ("discrete_gradient", "backward_euler")


@pytest.mark.parametrize("way", WAYS)
def test_a_pushed_block_sticks_slips_and_sticks(way: str) -> None:
    solution = solve(pushed_block(method={"segments": 20, "discretisation": way}))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.objective == pytest.approx(EFFORT, rel=2e-3)
    assert solution.mode_sequence is not None
    words = [mode.contacts["foot"] for mode in solution.mode_sequence.modes]
    assert words == ["sticking", "sliding_right", "sticking"]


def test_finer_steps_come_closer() -> None:
    errors = [
        abs((solve(pushed_block(method={"segments": n})).objective or 0.0) - EFFORT)
        for n in (12, 48)
    ]
    assert errors[1] < errors[0] / 4


def test_results_have_forces_and_impulses_of_steps_and_no_slacks() -> None:
    solution = solve(pushed_block(method={"segments": 10}))
    (phase,) = solution.phases
    assert list(phase.groups) == ["states", "controls", "forces", "impulses"]
    assert list(phase.groups["controls"].values) == ["f"]
    names = ["contact.foot.normal", "contact.foot.tangential"]
    assert list(phase.groups["forces"].values) == names
    assert phase.groups["forces"].time == phase.knots[1:]
    assert len(phase.groups["states"].time) == 11
    normal = np.array(phase.groups["forces"].values[names[0]], dtype=float)
    assert normal == pytest.approx(9.81, abs=1e-9)
    assert phase.groups["impulses"].values[names[0]] == pytest.approx(0.3 * normal)
    assert solution.static == {}
    assert not [
        name for group in phase.curves.values() for name in group.coefficients if "#" in name
    ]


def test_the_homotopy_is_told() -> None:
    solution = solve(pushed_block(method={"segments": 10}))
    told = solution.complementarity
    assert told is not None
    assert [one.relaxation for one in told.passes] == [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-7]
    assert told.polished
    assert told.residual is not None
    assert told.residual < 1e-8
    assert told.stationarity == "strong"
    assert told.pinned == 2, "the gap at the end, which is given there"


@pytest.mark.parametrize("form", ["inequality", "summed", "fischer_burmeister"])
def test_other_relaxations_come_to_the_same(form: str) -> None:
    found = solve(pushed_block(method={"segments": 10, "relaxation": {"form": form}}))
    exact = solve(pushed_block(method={"segments": 10}))
    assert found.status is SolutionStatus.CONVERGED, found.message
    assert found.objective == pytest.approx(exact.objective, rel=1e-6)


def test_without_slip_nothing_moves() -> None:
    """Under the law of 001 what presses does not slide, so the block cannot be pushed."""
    method = {"segments": 10, "friction": "no_slip"}
    solution = solve(pushed_block(method=method, limits={"seconds": 30}))
    assert solution.status is not SolutionStatus.CONVERGED


def test_a_problem_without_contacts_is_left_alone() -> None:
    plain = pushed_block(method={"kind": "radau"})
    assert as_stepped(plain) is plain
    assert contacts_of(plain).problem is plain


def test_meshes_are_doubled_until_little_is_lost() -> None:
    method = {"segments": 8, "dissipation": 0.05}
    solution = solve(pushed_block(method=method, refinement={"max_iterations": 4}))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    meshes = solution.mesh_refinement.iterations
    assert [mesh.segments for mesh in meshes] == [8 * 2**k for k in range(len(meshes))]
    lost = [mesh.max_error or 0.0 for mesh in meshes]
    assert lost[-1] <= 0.05 < lost[-2]
    assert solution.mesh_refinement.tolerance == 0.05


def test_the_limit_of_meshes_is_told() -> None:
    method = {"segments": 8, "dissipation": 1e-4}
    solution = solve(pushed_block(method=method, refinement={"max_iterations": 2}))
    assert solution.status is SolutionStatus.MESH_LIMIT


def test_steps_share_the_time_of_pairs() -> None:
    """What they share is theirs; each stays within its bounds, and it can only help."""
    solution = solve(pushed_block(method={"segments": 20, "steps": "pairwise"}))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    knots = np.array(solution.phases[0].knots)
    lengths = np.diff(knots)
    assert knots[::2] == pytest.approx(np.linspace(0, 3, 11))
    assert np.ptp(lengths) > 0.01
    assert lengths.min() >= 0.4 * 0.15 - 1e-9
    even = solve(pushed_block(method={"segments": 20}))
    assert (solution.objective or np.inf) < (even.objective or 0.0)
    names = [name for group in solution.phases[0].groups.values() for name in group.values]
    assert not [name for name in names if "#" in name]


def test_the_clock_of_pairs_is_refused() -> None:
    with pytest.raises(BadProblem, match="time t"):
        pushed_block(method={"steps": "pairwise"}, integrals={"effort": "t*f^2"})


def test_steps_in_which_contacts_change_are_halved_twice() -> None:
    """A block that is pushed while it falls: two of eight steps have to do with its landing."""
    posed = pushed_block(
        method={"segments": 8, "split_changes": True, "dissipation": 1e-6},
        initial={"x": 0, "y": 0.5, "d(x)": 0, "d(y)": 0},
        final={},
        bounds={"f": [2, 2], "x": [-20, 20], "y": [-1, 1]},
        time={"final": 1},
        refinement={"max_iterations": 2},
    )
    meshes = solve(posed).mesh_refinement.iterations
    assert [mesh.segments for mesh in meshes] == [8, 2 * 8 + 2 * 2]


def test_which_steps_these_are() -> None:
    normal = [0.0, 0.0, 5.0, 5.0, 5.0]
    result = published(
        np.arange(6.0),
        {"x": np.zeros(6), "d(x)": np.zeros(1)},
        {},
        {"contact.foot.normal": np.array(normal)},
    )
    assert changes(result).tolist() == [False, True, True, False, False]


@pytest.mark.parametrize(("bearing", "begins"), [(False, 0.0), (True, 9.81)])
def test_contacts_of_the_guess_may_bear_the_weight(bearing: bool, begins: float) -> None:
    posing = Posing.of(pushed_block(method={"segments": 4, "bearing": bearing}))
    _, setting = posing.prepared()
    normal = setting.guesses[0].sample(["contact.foot.normal"], np.array([0.2, 0.8]))
    assert normal[0] == pytest.approx(begins)


def test_a_formula_beside_steps_is_none_of_them() -> None:
    """The problem's method is for what has bodies; the block's end is where the formula starts."""
    document = pushed_block(method={"segments": 10}).model_dump(mode="json", exclude_defaults=True)
    formula = {"kind": "closed_form", "states": {"s": "initial.s + (t - initial.t)"}}
    after = {"name": "after", "system": formula, "time": {"duration": 1}}
    document["phases"].append(after)
    document["objective"] = {"minimize": "move.effort"}
    link = {"name": "s", "expression": "move.final.x - after.initial.s", "lower": 0, "upper": 0}
    solution = solve(reread(pushed_block(), **(document | {"linkages": [link]})))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.phases[1].groups["states"].values["s"][-1] == pytest.approx(2.0)


def test_a_schedule_that_rises_is_refused_with_a_mend() -> None:
    with pytest.raises(BadProblem) as caught:
        pushed_block(method={"relaxation": {"schedule": [1e-3, 1e-2]}})
    assert "such as" in caught.value.issues[0].hint
