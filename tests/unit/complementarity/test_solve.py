"""Small programs of the literature, by every form, with every recovery."""

from collections.abc import Callable
from math import inf
from types import NoneType
from typing import get_args

import pytest

from schemas.methods import Relaxation
from solver.backends import NlpStatus, Watch
from solver.complementarity import FORMS, PairsWon, paired_scaling, unpaired
from tests.unit.complementarity.programs import Stated, pair, solved, stated, watched

FREE = {"x": (0.5, 0.0, inf), "y": (0.4, 0.0, inf)}
Posed = Callable[[str], Stated]


def posed(objective: str, **more: object) -> Posed:
    """Two variables at least zero, one of them zero."""
    return lambda form: stated(FREE, objective, [pair("x", "y")], form=form, **more)  # type: ignore[arg-type]


PROGRAMS: dict[str, tuple[Posed, float, set[tuple[float, float]]]] = {
    # Scholtes' first example, kth1 to kth3, ralph2 and scholtes3 of MacMPEC (Leyffer, 2000).
    "two minima": (posed("(x-1)^2 + (y-1)^2"), 1.0, {(1, 0), (0, 1)}),
    "kth1": (posed("x + y"), 0.0, {(0, 0)}),
    "kth2": (posed("x + (y-1)^2"), 0.0, {(0, 1)}),
    "ralph2": (posed("x^2 + y^2 - 4*x*y"), 0.0, {(0, 0)}),
    "one side": (posed("(x-1)^2 + (y-2)^2", rows={"y": (-inf, 0.5)}), 3.25, {(0, 0.5)}),
}


def both(won: PairsWon, problem: Stated) -> tuple[float, float]:
    at = problem.at(won.won.outcome.point.z)
    return at["x"], at["y"]


def test_every_form_of_the_schema_is_there() -> None:
    literal, none = get_args(Relaxation.model_fields["form"].annotation)
    assert set(get_args(literal)) == set(FORMS)
    assert none is NoneType


@pytest.mark.parametrize("backend", ["ipopt", "uno"])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_of_the_literature(name: str, form: str, backend: str) -> None:
    make, objective, minima = PROGRAMS[name]
    problem = make(form)
    won = solved(problem, form=form, backend=backend)
    assert won.won.outcome.status is NlpStatus.OPTIMAL
    assert won.polished
    assert not won.stalled
    assert won.won.outcome.point.objective == pytest.approx(objective, abs=1e-7)
    x, y = both(won, problem)
    assert min(x, y) <= 1e-10
    assert x * y <= 1e-10
    assert won.residual <= 1e-10
    assert any(abs(x - a) < 1e-4 and abs(y - b) < 1e-4 for a, b in minima)
    assert won.won.outcome.iterations >= sum(one.nlp_iterations for one in won.passes)
    assert [one.relaxation for one in won.passes] == Relaxation().schedule


def test_sizes_and_scales_change_nothing() -> None:
    """A force in newtons, which the program scales, over the weight."""
    variables = {"x": (0.5, 0.0, inf), "f": (400.0, 0.0, inf)}
    problem = stated(
        variables,
        "(x-1)^2 + (f/1000-1)^2",
        [pair("x", "f", sizes=(1.0, 1000.0))],
        scales={"f": 200.0},
    )
    won = solved(problem, polish=False, schedule=[1e-1, 1e-2, 1e-3])
    at = problem.at(won.won.outcome.point.z)
    assert at["x"] * at["f"] / 1000.0 == pytest.approx(1e-3, rel=1e-4)
    assert won.product == pytest.approx(1e-3, rel=1e-4)
    assert won.passes[-1].residual == pytest.approx(1e-3, rel=1e-4)


@pytest.mark.parametrize("form", ["equality", "fischer_burmeister"])
def test_without_polish_the_products_are_the_relaxation(form: str) -> None:
    problem = PROGRAMS["two minima"][0](form)
    won = solved(problem, form=form, polish=False)
    assert not won.polished
    assert not won.stalled
    assert won.stationarity is None
    assert won.product == pytest.approx(1e-7, rel=0.1)


@pytest.mark.parametrize("form", FORMS)
def test_a_program_without_a_solution_stalls(form: str) -> None:
    """Both members have to be 1: at a relaxation of 1 it can be met, then never again."""
    problem = posed("x + y", rows={"x": (1, inf), "y": (1, inf)})(form)
    won = solved(problem, form=form, schedule=[1.0, 1e-2])
    assert won.stalled
    assert not won.polished
    assert won.residual == pytest.approx(1.0, abs=1e-5)


def test_what_can_never_be_met_is_infeasible() -> None:
    problem = posed("x + y", rows={"x": (1, inf), "y": (2, inf), "x + y": (-inf, 2)})("equality")
    won = solved(problem)
    assert won.won.outcome.status is NlpStatus.INFEASIBLE
    assert not won.stalled
    forms = [one.form for one in won.passes]
    assert forms[0] == "equality"
    assert forms[-1] == "inequality"


def test_a_step_too_large_is_made_smaller() -> None:
    """Equality cannot hold at 2, for x y <= 1 throughout; inequality can."""
    rows = {"x": (-inf, 1.0), "y": (-inf, 1.0)}
    problem = posed("(x-1)^2 + (y-1)^2", rows=rows)("equality")
    won = solved(problem, schedule=[2.0, 1e-3, 1e-5])
    assert [one.status for one in won.passes[:2]] == ["infeasible", "infeasible"]
    assert won.form == "inequality"
    assert won.polished
    assert not won.stalled
    assert won.won.outcome.point.objective == pytest.approx(1.0, abs=1e-7)


def test_a_gap_that_is_fixed_at_zero_takes_the_inequality() -> None:
    """As at an end that asks for contact: the slack's row, not its bounds, makes it zero."""
    variables = {"q": (1.0, 1.0, 1.0), "gap": (0.2, 0.0, inf), "force": (0.3, 0.0, inf)}
    problem = stated(
        variables, "(force-3)^2", [pair("gap", "force")], rows={"gap - (q^2 - 1)": (0.0, 0.0)}
    )
    won = solved(problem)
    assert won.pinned == 1
    assert won.form == "equality"
    assert [one.status for one in won.passes] == ["optimal"] * len(won.passes)
    assert problem.at(won.won.outcome.point.z)["force"] == pytest.approx(3.0, abs=1e-7)


def test_a_gap_that_is_fixed_open_is_not_pinned() -> None:
    variables = {"q": (2.0, 2.0, 2.0), "gap": (0.2, 0.0, inf), "force": (0.3, 0.0, inf)}
    problem = stated(
        variables, "(force-3)^2", [pair("gap", "force")], rows={"gap - (q^2 - 1)": (0.0, 0.0)}
    )
    won = solved(problem)
    assert won.pinned == 0
    assert problem.at(won.won.outcome.point.z)["force"] == pytest.approx(0.0, abs=1e-9)


def test_rest_at_the_end_pins_the_gap_a_step_before() -> None:
    """At rest the last step moves nothing, however long it is."""
    variables = {
        "q": (0.5, -inf, inf),
        "end": (0.0, 0.0, 0.0),
        "rate": (0.0, 0.0, 0.0),
        "h": (0.3, 0.1, 1.0),
        "gap": (0.2, 0.0, inf),
        "force": (0.3, 0.0, inf),
    }
    rows = {"end - q - h*rate": (0.0, 0.0), "gap - sin(q)": (0.0, 0.0)}
    problem = stated(variables, "(force-3)^2", [pair("gap", "force")], rows=rows)
    assert solved(problem).pinned == 1
    moving = variables | {"rate": (1.0, 1.0, 1.0)}
    problem = stated(moving, "(force-3)^2 + h", [pair("gap", "force")], rows=rows)
    assert solved(problem).pinned == 0


def test_a_polish_that_comes_to_nothing_goes_on_below_the_schedule() -> None:
    """At 0.1 the smaller member is y = 0.2, which cannot be zero; at 0.01 it is x = 0.05."""
    problem = posed("(x-1)^2 + y^2", rows={"y": (0.2, inf)})("equality")
    won = solved(problem, schedule=[1.0, 0.1])
    assert [one.relaxation for one in won.passes] == pytest.approx([1.0, 0.1, 1e-2, 1e-3])
    assert won.polished
    assert not won.stalled
    assert both(won, problem) == pytest.approx((0.0, 0.2), abs=1e-8)
    passed = sum(one.nlp_iterations for one in won.passes)
    assert won.won.outcome.iterations > passed  # polishes that came to nothing count, too


def test_without_a_polish_the_schedule_is_the_end() -> None:
    problem = posed("(x-1)^2 + y^2", rows={"y": (0.2, inf)})("equality")
    won = solved(problem, schedule=[1.0, 0.1], polish=False)
    assert [one.relaxation for one in won.passes] == [1.0, 0.1]


def test_a_schedule_that_was_met_has_not_stalled_where_no_polish_helps() -> None:
    """Both members have to be 1, which a relaxation of 1 allows and no smaller one."""
    problem = posed("x + y", rows={"x": (1, inf), "y": (1, inf)})("inequality")
    won = solved(problem, form="inequality", schedule=[1.0])
    assert won.passes[0].status == "optimal"
    assert not won.polished
    assert len(won.passes) > 1
    assert not won.stalled


def test_a_stop_ends_with_the_last_good_pass() -> None:
    problem = PROGRAMS["two minima"][0]("equality")
    seen: list[int] = []

    def watch() -> Watch:
        seen.append(len(seen))
        return watched(should_stop=lambda: len(seen) == 3)

    won = solved(problem, watch=watch)
    assert won.won.outcome.status is NlpStatus.STOPPED
    assert [one.status for one in won.passes] == ["optimal", "optimal", "stopped"]
    assert not won.stalled
    assert won.product == pytest.approx(Relaxation().schedule[1], rel=1e-3)


def test_members_are_scaled_by_their_sizes_and_rows_open() -> None:
    one = pair("x", "y", sizes=(0.5, 1000.0))
    problem = stated(FREE, "x + y", [one], rows={"x + y": (0.0, 1.0)})
    scaling = paired_scaling(problem.program, problem.scaling, [one])
    assert scaling.columns.tolist() == [0.5, 1000.0, 1.0]
    rows = unpaired(problem.program, [one]).groups[0].rows
    assert rows.lower.tolist() == [0.0, -inf]
    assert rows.upper.tolist() == [1.0, inf]
