"""What only numbers tell of a mechanism: each is refused, with what would do."""

from typing import Any

import pytest

from schemas.errors import InvalidModel
from schemas.mechanisms import Mechanism
from schemas.problem import Problem
from schemas.reading import read_problem
from solver.mechanics import limited
from solver.pipeline import solve
from solver.poses import loosened
from solver.prepare import prepare


def four_bar(ground: float = 1.0, crank: float = 0.4) -> dict[str, Any]:
    bars = {"crank": crank, "rod": 1.1, "rocker": 0.8}
    ends = [{"body": "rod", "at": [1.1, 0]}, {"body": "rocker", "at": [0.8, 0]}]
    return {
        "bodies": {
            name: {"mass": 1, "inertia": 0.1, "com": [length / 2, 0]}
            for name, length in bars.items()
        },
        "joints": {
            "one": {"kind": "revolute", "child": "crank"},
            "two": {"kind": "revolute", "parent": "crank", "child": "rod", "at": [crank, 0]},
            "three": {"kind": "revolute", "child": "rocker", "at": [ground, 0]},
        },
        "loops": {"pin": {"between": ends}},
    }


def arm(**more: Any) -> dict[str, Any]:
    """Two links of a metre whose tip may touch the ground."""
    link = {"mass": 1, "inertia": 0.1, "com": [0.5, 0]}
    elbow = {"kind": "revolute", "parent": "upper", "child": "lower", "at": [1, 0]}
    return {
        "bodies": {"upper": link, "lower": link},
        "joints": {
            "shoulder": {"kind": "revolute", "child": "upper", "limits": [-2, 2]},
            "elbow": {**elbow, "limits": [0, 2]},
        },
        "contacts": {"tip": {"body": "lower", "at": [1, 0]}},
        **more,
    }


def problem(system: dict[str, Any], **phase: Any) -> Problem:
    only = {"system": {"kind": "mechanism", **system}, "time": {"final": 1}, **phase}
    return limited(read_problem({"phases": [only], "method": {"kind": "radau", "segments": 2}}))


def refused(system: dict[str, Any], **phase: Any) -> tuple[str, str, str]:
    with pytest.raises(InvalidModel) as error:
        prepare(problem(system, **phase))
    (issue,) = error.value.issues
    return issue.pointer, issue.message, issue.hint


@pytest.mark.parametrize(
    ("system", "phase"),
    [
        (four_bar(), {}),
        (four_bar(), {"initial": {"one": 0.3}}),
        (arm(), {"initial": {"tip.x": 1.5, "tip.y": 0.3}}),
        (arm(), {"initial": {"shoulder": -0.5}}),
        (arm(mode={"tip": "sticking"}), {"initial": {"shoulder": -0.5}}),
        (arm(surfaces={"ground": {"height": -3}}), {"initial": {"shoulder": -1, "elbow": 0}}),
    ],
)
def test_poses_that_there_are_are_let_pass(system: dict[str, Any], phase: dict[str, Any]) -> None:
    prepare(problem(system, **phase))


def test_a_loop_that_cannot_close() -> None:
    place, message, hint = refused(four_bar(ground=3.0))
    assert place == "/phases/0/system/loops/pin"
    assert "0.7 m stay open" in message  # 3 - 0.4 - 1.1 - 0.8
    assert hint.startswith("the closest pose is one = ")


def test_a_loop_that_its_ends_do_not_close() -> None:
    place, message, hint = refused(four_bar(), final={"one": 0.3, "two": 0, "three": 2})
    assert place == "/phases/0/system/loops/pin"
    assert "stay open" in message
    assert hint.startswith("nearest within the limits of the joints: one = ")


def test_a_place_out_of_reach() -> None:
    place, message, hint = refused(arm(), initial={"tip.x": 2.5, "tip.y": 0})
    assert place == "/phases/0/initial/tip.x"
    assert message == "'tip.x' misses this by 0.5"
    assert "the closest pose is" in hint


def test_a_start_inside_of_the_ground() -> None:
    place, message, hint = refused(arm(), initial={"shoulder": "-pi/6", "elbow": 0})
    assert place == "/phases/0/initial"
    assert message == "'tip' starts 1 m inside of 'ground'"
    assert "shoulder = " in hint


def test_a_start_where_the_ground_has_no_height() -> None:
    system = arm(surfaces={"ground": {"height": "sqrt(x)"}})
    system["joints"]["shoulder"]["limits"] = [-4, 4]
    place, message, hint = refused(system, initial={"shoulder": "pi", "elbow": 0})
    assert place == "/phases/0/initial"
    assert message == "'contact.tip.gap' has no finite value there"
    assert "shoulder = " in hint


def test_a_contact_that_cannot_touch() -> None:
    system = arm(mode={"tip": "sticking"}, surfaces={"ground": {"height": -3}})
    place, message, _ = refused(system)
    assert place == "/phases/0/system/mode/tip"
    assert "a gap of 1 m" in message  # 3 below, and two metres of reach


def test_a_coordinate_without_inertia() -> None:
    point = {"mass": 1, "inertia": 0}
    system = arm(contacts={})
    system["bodies"]["lower"] = point
    place, message, _ = refused(system)
    assert place == "/phases/0/system/bodies"
    assert "the acceleration of 'elbow'" in message


def block(**more: Any) -> dict[str, Any]:
    """A block on two feet."""
    feet = {
        "left": {"body": "block", "at": [-1, -0.2]},
        "right": {"body": "block", "at": [1, -0.2]},
    }
    return {
        "bodies": {"block": {"mass": 2, "inertia": 0.1}},
        "joints": {"free": {"kind": "floating", "child": "block"}},
        "contacts": feet,
        "mode": {"left": "sticking", "right": "sticking"},
        "controls": ["push"],
        "forces": {"push": {"body": "block", "at": [0, 0], "direction": [1, 0], "value": "push"}},
        **more,
    }


def test_the_second_force_along_the_ground_is_loose() -> None:
    (phase,) = loosened(problem(block())).phases
    assert isinstance(phase.system, Mechanism)
    assert phase.system.loose == ["contact.right.tangential"]
    assert phase.system.control_names == ["push", "contact.right.tangential"]


@pytest.mark.parametrize("modes", [{"left": "sticking"}, {"left": "sticking", "right": "sliding"}])
def test_forces_that_the_motion_gives_stay_so(modes: dict[str, str]) -> None:
    given = problem(block(mode=modes))
    assert loosened(given) is given


def test_a_block_on_two_feet_is_solved_and_certified() -> None:
    rest = {f"block.{name}": 0 for name in ("x", "angle", "d(x)", "d(y)", "d(angle)")}
    found = solve(
        read_problem(
            {
                "phases": [
                    {
                        "system": {"kind": "mechanism", **block()},
                        "time": {"final": 1},
                        "initial": {**rest, "block.y": 0.2},
                        "bounds": {"push": [4, 9]},
                        "integrals": {"effort": "push^2", "lean": "contact.right.tangential"},
                    }
                ],
                "objective": {"minimize": "effort"},
                "method": {"kind": "radau", "segments": 2},
                "refinement": None,
            }
        )
    )
    assert found.certificate.verdict == "certified"
    assert found.objective == pytest.approx(16, rel=1e-6)
    both = found.phases[0].integrals["lean"]
    assert both == pytest.approx(0, abs=1e-3)  # drawn to zero: the left foot holds the block
