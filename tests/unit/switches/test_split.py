"""A split problem says the same as the whole one, and its parts join to the same motion."""

from typing import Any

import numpy as np
import pytest

from footfall.curves import Curves
from schemas import resolve
from schemas.expressions import Expression, Name, Tree, names_in
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import PhaseResult
from solver.numeric import evaluate
from solver.switches.join import by_phase, guesses, join, restrict, whole
from solver.switches.propose import propose
from solver.switches.split import SHORTEST, Cut, Plan, split
from solver.trajectory import Trajectory
from tests.unit.switches.curves import problem, published

NONE = Cut(0.0, 1.0)
CUT = Cut(0.0, 2.0, (0.5, 1.25))


def two_phases() -> Problem:
    """A phase that runs and one that coasts, all over each other's ends."""
    first = problem().phases[0].model_dump(mode="json")
    run = first | {
        "name": "run",
        "time": {"initial": 0, "duration": [0.1, "2*most"]},
        "boundary": [
            {"name": "far", "expression": "final.x - initial.x + duration", "lower": "most"},
            {"name": "cheap", "expression": "effort*most", "upper": 3},
        ],
        "integrals": {"effort": "u^2", "way": "abs(v)"},
    }
    coast = first | {"name": "coast", "time": {"final": [0, 9]}, "integrals": {"effort": "u^4"}}
    return read_problem(
        {
            "static": {"gain": {"bounds": [0, 1]}},
            "phases": [run, coast | {"initial": {}}],
            "linkages": [
                {"name": "x", "expression": "run.final.x - coast.initial.x", "lower": 0, "upper": 0}
            ],
            "objective": {"minimize": "run.effort^2 + gain*run.duration + run.way/coast.final.v"},
        }
    )


def ends_of(values: dict[str, float], name: str, parts: list[str]) -> dict[str, float]:
    """Random ends and integrals of the parts, and into ``values`` what the phase makes of them."""
    rng = np.random.default_rng(len(name))
    times = np.cumsum(rng.uniform(0.1, 1, len(parts) + 1))
    given: dict[str, float] = {}
    for number, part in enumerate(parts):
        drawn = {key: float(rng.normal()) for key in ("effort", "way")}
        drawn |= {
            f"{end}.{key}": float(rng.normal()) for end in ("initial", "final") for key in "xvu"
        }
        drawn |= {"initial.t": times[number], "final.t": times[number + 1], "most": 1.0}
        given |= {f"{part}.{key}": value for key, value in drawn.items()}
    for key in ("x", "v", "u", "t"):
        values[f"{name}.initial.{key}"] = given[f"{parts[0]}.initial.{key}"]
        values[f"{name}.final.{key}"] = given[f"{parts[-1]}.final.{key}"]
    values[f"{name}.duration"] = times[-1] - times[0]
    for key in ("effort", "way"):
        values[f"{name}.{key}"] = sum(given[f"{part}.{key}"] for part in parts)
    return given


def row(problem: Problem, name: str) -> Any:
    """A linkage by name."""
    return next(link for link in problem.linkages if link.name == name)


def test_the_objective_and_the_constraints_have_the_same_values() -> None:
    posed = two_phases()
    parted, plan = split(posed, [CUT, NONE])
    assert plan.counts == [3, 1]
    names = [phase.name for phase in parted.phases]
    values = {"gain": 0.7}
    given = {"gain": 0.7} | ends_of(values, "run", names[:3]) | ends_of(values, "coast", names[3:])
    given |= {key: value for key, value in values.items() if key.startswith("coast.")}

    assert posed.objective is not None
    assert parted.objective is not None
    assert evaluate(parted.objective.minimize.tree, given) == pytest.approx(
        evaluate(posed.objective.minimize.tree, values), rel=1e-14
    )
    link = posed.linkages[0].expression.tree
    assert evaluate(row(parted, "x").expression.tree, given) == evaluate(link, values)
    own = {key.removeprefix("run."): value for key, value in values.items()} | {"most": 1.0}
    for constraint in posed.phases[0].boundary:
        tree = row(parted, constraint.name).expression.tree
        assert evaluate(tree, given) == pytest.approx(evaluate(constraint.expression.tree, own))
    limits = resolve.interval(row(parted, "far"), {})
    assert limits == (1.0, np.inf), "the phase's parameters are numbers"
    assert resolve.interval(row(parted, "duration"), {}) == (0.1, 2.0)


def test_every_name_of_a_split_problem_belongs_to_a_part() -> None:
    parted, _ = split(two_phases(), [CUT, Cut(2.0, 3.0, (2.5,))])
    heads = {phase.name for phase in parted.phases} | {"gain"}
    assert parted.objective is not None
    trees: list[Tree] = [parted.objective.minimize.tree]
    trees += [link.expression.tree for link in parted.linkages]
    used = {name.name.split(".")[0] for tree in trees for name in names_in(tree)}
    assert used <= heads
    assert not used & {"run", "coast"}


def test_texts_stay_the_users() -> None:
    posed = two_phases()
    parted, _ = split(posed, [CUT, NONE])
    assert posed.objective is not None
    assert parted.objective is not None
    assert str(parted.objective.minimize) == str(posed.objective.minimize)


def test_a_phase_alone_may_be_called_without_its_name() -> None:
    posed = problem(integrals={"effort": "u^2"})
    parted, _ = split(posed, [CUT])
    assert parted.objective is not None
    tree = parted.objective.minimize.tree
    assert [name.name for name in names_in(tree)] == ["move/3.final.t", "move/1.initial.t"]


def test_ends_bounds_and_times_of_the_parts() -> None:
    row = {"name": "high", "expression": "x + v", "upper": 3}
    posed = problem(path=[row], integrals={"effort": "u^2"})
    parted, _ = split(posed, [CUT])
    first, middle, last = parted.phases
    phase = posed.phases[0]
    assert [first.initial, middle.initial, last.initial] == [phase.initial, {}, {}]
    assert [first.final, middle.final, last.final] == [{}, {}, phase.final]
    for part in parted.phases:
        assert part.bounds == phase.bounds
        assert part.path == phase.path
        assert part.integrals == phase.integrals
        assert part.system == phase.system
        assert part.time.duration is not None
        assert resolve.interval(part.time.duration, {}) == (SHORTEST * 2.0, np.inf)
    assert first.time.initial == phase.time.initial
    assert [part.time.final for part in parted.phases] == [None, None, phase.time.final]
    assert [part.method.segments for part in parted.phases if part.method] == [7, 10, 10]


def test_states_are_continuous_and_controls_are_free() -> None:
    parted, _ = split(problem(), [CUT])
    linked = [str(link.expression) for link in parted.linkages]
    assert linked == [
        f"move/{one}.final.{name} - move/{one + 1}.initial.{name}"
        for one in (1, 2)
        for name in ("x", "v")
    ]
    assert all(resolve.interval(link, {}) == (0, 0) for link in parted.linkages)


def test_a_control_whose_rate_is_used_does_not_jump() -> None:
    parted, _ = split(problem(integrals={"rate": "d(u)^2"}), [Cut(0.0, 2.0, (1.0,))])
    linked = {name.name for link in parted.linkages for name in names_in(link.expression.tree)}
    assert {"move/1.final.u", "move/2.initial.u"} <= linked


def test_no_times_no_change() -> None:
    posed = two_phases()
    parted, plan = split(posed, [NONE, NONE])
    assert parted is posed
    assert plan.counts == [1, 1]


def plan_of_three() -> Plan:
    return split(problem(integrals={"effort": "u^2"}), [CUT])[1]


def parts() -> list[PhaseResult]:
    """Three parts of one motion with a jump of the control at 0.5 s; degrees differ."""
    return [
        published(np.cos, 4, np.sin, "move", (0.0, 0.5)),
        published(lambda t: -np.cos(t), 3, np.sin, "move", (0.5, 1.25), points=5),
        published(lambda t: -np.cos(t), 5, np.sin, "move", (1.25, 2.0)),
    ]


def test_the_parts_join_to_one_phase() -> None:
    pieces = parts()
    (joined,) = join(plan_of_three(), pieces)
    assert joined.name == "move"
    assert joined.integrals == {"effort": 3.0}
    assert len(joined.knots) == 4 + 3 + 5 + 1
    for piece in pieces:
        times = np.linspace(piece.knots[0] + 1e-9, piece.knots[-1] - 1e-9, 50)
        for group in ("states", "controls"):
            own = Curves.from_dict(piece.curves[group].model_dump()).sample(times)
            whole_curves = Curves.from_dict(joined.curves[group].model_dump()).sample(times)
            for name, values in own.items():
                np.testing.assert_allclose(whole_curves[name], values, atol=1e-14)


def test_a_jump_repeats_the_time_and_nothing_else_does() -> None:
    (joined,) = join(plan_of_three(), parts())
    controls, states = joined.groups["controls"], joined.groups["states"]
    assert controls.time.count(0.5) == 2
    assert states.time.count(0.5) == 1
    assert len(states.time) == len(states.values["x"])
    assert len(controls.time) == len(controls.values["u"])


def test_an_unknown_integral_stays_unknown() -> None:
    pieces = parts()
    pieces[1] = pieces[1].model_copy(update={"integrals": {"effort": None}})
    (joined,) = join(plan_of_three(), pieces)
    assert joined.integrals == {"effort": None}


def trajectory() -> Trajectory:
    """A quadratic and a sine on five segments."""
    times = np.linspace(0.0, 2.0, 6)
    nodes = np.array([-1.0, 0.0, 1.0])
    at = times[:-1, None] + 0.2 * (nodes + 1)
    states = Curves.through(["x", "v"], times, nodes, np.stack([at**2, np.sin(at)], axis=2))
    controls = Curves.through(["u"], times, nodes, np.cos(at)[:, :, None])
    return Trajectory(0.0, 2.0, states, controls)


def test_a_part_of_a_trajectory_is_the_same_motion() -> None:
    motion = trajectory()
    part = restrict(motion, 0.3, 1.7)
    assert (part.start, part.end) == (0.3, 1.7)
    times = np.linspace(0.3, 1.7, 101)
    for name in ("x", "v"):
        np.testing.assert_allclose(part.states[name](times), motion.states[name](times))
    np.testing.assert_allclose(part.controls["u"](times), motion.controls["u"](times))


def test_guesses_and_the_whole_are_inverse() -> None:
    motion, plan = trajectory(), plan_of_three()
    pieces = guesses(plan, [motion])
    assert [(piece.start, piece.end) for piece in pieces] == CUT.spans
    (again,) = whole(plan, pieces)
    times = np.linspace(0.0, 2.0, 101)
    np.testing.assert_allclose(again.states["v"](times), motion.states["v"](times))
    assert (again.start, again.end) == (0.0, 2.0)


def test_items_go_to_their_phases() -> None:
    plan = Plan(two_phases(), (CUT, NONE))
    assert by_phase(plan, "abcd") == [["a", "b", "c"], ["d"]]


def bang(switch: float) -> Any:
    return lambda t: np.where(t < switch, 1.0, -1.0)


def test_the_first_round_splits_where_the_control_jumps() -> None:
    (cut,) = propose(problem(), [published(bang(1.03))], {}) or []
    assert cut.times == pytest.approx((1.03,), abs=0.05)
    assert (cut.start, cut.end) == (0.0, 2.0)


def test_without_a_switch_there_is_nothing_to_split() -> None:
    assert propose(problem(), [published(np.sin)], {}) is None


def test_a_joint_that_holds_is_not_split_again() -> None:
    pieces = [
        published(np.ones_like, 4, span=(0.0, 1.03)),
        published(lambda t: -np.ones_like(t), 4, span=(1.03, 2.0)),
    ]
    plan = split(problem(), [Cut(0.0, 2.0, (1.0,))])[1]
    assert propose(problem(), pieces, {}, plan) is None


def test_a_part_that_has_shrunk_to_nothing_goes_with_the_next_split() -> None:
    pieces = [
        published(np.ones_like, 4, span=(0.0, 1.0)),
        published(np.zeros_like, 4, span=(1.0, 1.0002)),
        published(lambda t: np.where(t < 1.5, 0.0, -1.0), 10, span=(1.0002, 2.0)),
    ]
    plan = split(problem(), [Cut(0.0, 2.0, (1.0, 1.1))])[1]
    (cut,) = propose(problem(), pieces, {}, plan) or []
    assert cut.times == pytest.approx((1.0, 1.5), abs=0.05)
    pieces[2] = published(lambda t: -np.ones_like(t), 4, span=(1.0002, 2.0))
    assert propose(problem(), pieces, {}, plan) is None, "alone it is no reason to solve again"


def test_a_second_round_adds_what_is_new() -> None:
    pieces = [
        published(np.ones_like, 10, span=(0.0, 1.0)),
        published(lambda t: np.where(t < 1.5, 0.0, -1.0), 10, span=(1.0, 2.0)),
    ]
    plan = split(problem(), [Cut(0.0, 2.0, (1.0,))])[1]
    (cut,) = propose(problem(), pieces, {}, plan) or []
    assert cut.times == pytest.approx((1.0, 1.5), abs=0.05)


def test_trees_are_rewritten_whole() -> None:
    tree = Expression.read("2*duration + sin(initial.x)").tree
    posed = problem(
        boundary=[{"name": "b", "expression": "2*duration + sin(initial.x)", "upper": 1}]
    )
    parted, _ = split(posed, [CUT])
    rewritten = row(parted, "b").expression.tree
    assert Name("duration", 3) in names_in(tree)
    assert {name.name for name in names_in(rewritten)} == {
        "move/3.final.t",
        "move/1.initial.t",
        "move/1.initial.x",
    }
