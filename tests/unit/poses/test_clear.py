"""Ends of phases that are stepped through contact: depth, contact, and a pose that is clear."""

import math
from typing import Any

import pytest

from schemas.errors import InvalidModel, Issue
from schemas.reading import read_problem
from solver.mechanics import limited
from solver.poses import check_clear
from tests.support.robots import PENDULUM, link, robot

Document = dict[str, Any]

SLED = {
    "kind": "mechanism",
    "bodies": {"sled": {"mass": 1, "inertia": 0.1}},
    "joints": {"free": {"kind": "floating", "child": "sled"}},
    "contacts": {
        "heel": {"body": "sled", "at": [-0.5, -0.2]},
        "toe": {"body": "sled", "at": [0.5, -0.2]},
    },
}
ARM = {
    "kind": "mechanism",
    "bodies": {"ball": {"mass": 1, "inertia": 0.1}, "arm": {"mass": 1, "inertia": 0.1}},
    "joints": {
        "free": {"kind": "floating", "child": "ball"},
        "shoulder": {"kind": "revolute", "child": "arm", "limits": [-1, 1]},
    },
    "angles": "absolute",
    "contacts": {"tip": {"body": "arm", "at": [1, 0]}, "rim": {"body": "ball", "radius": 0.1}},
    "shapes": {"round": {"body": "ball", "circle": 0.1}},
    "surfaces": {"floor": {"height": -2}},
    "pairs": {
        "kick": {"contact": "tip", "against": "round"},
        "rest": {"contact": "rim", "against": "floor"},
    },
}
LEVEL = {"sled.x": 0, "sled.angle": 0}


def checked(system: Document, kind: str = "contact_implicit", **more: Any) -> None:
    static = more.pop("static", {})
    phase = {"system": system, "time": {"final": 1}, **more}
    document = {"phases": [phase], "method": {"kind": kind}, "static": static}
    check_clear(limited(read_problem(document)))


def refused(system: Document, **more: Any) -> Issue:
    with pytest.raises(InvalidModel) as caught:
        checked(system, **more)
    (issue,) = caught.value.issues
    return issue


@pytest.mark.parametrize("kind", ["contact_implicit", "contact_implicit_polished"])
@pytest.mark.parametrize(
    "ends",
    [
        {},
        {"initial": {**LEVEL, "sled.y": 0.2}, "final": {**LEVEL, "sled.x": 1, "sled.y": 0.2}},
        {"initial": {**LEVEL, "sled.y": 0.2 - 1e-9}},
        {"initial": LEVEL, "final": {"sled.y": [0, 0.3]}},
        {"initial": {"sled.y": 0.1}},  # on its back
    ],
)
def test_ends_that_are_clear_or_touch_are_let_pass(kind: str, ends: Document) -> None:
    checked(SLED, kind, **ends)


def test_a_start_inside_of_the_ground() -> None:
    issue = refused(SLED, initial={**LEVEL, "sled.y": 0.15})
    assert issue.pointer == "/phases/0/initial"
    assert issue.message == "'heel' starts 0.05 m inside of 'ground'"
    hint = "nearest within the limits of the joints: sled.x = 0, sled.y = 0.2, sled.angle = 0"
    assert issue.hint == hint


def test_a_depth_that_the_audit_would_see() -> None:
    assert "starts 1e-05 m" in refused(SLED, initial={**LEVEL, "sled.y": 0.2 - 1e-5}).message


def test_a_goal_inside_of_the_ground() -> None:
    issue = refused(SLED, initial={**LEVEL, "sled.y": 0.2}, final={"sled.y": [-3, -1]})
    assert issue.pointer == "/phases/0/final"
    assert "ends 0.8 m inside of 'ground'" in issue.message  # upside down, at -1


def test_a_pose_that_is_offered_is_let_pass() -> None:
    hint = refused(SLED, initial={"sled.x": 0, "sled.angle": 0.1, "sled.y": 0.2}).hint
    pairs = (pair.split(" = ") for pair in hint.partition(": ")[2].split(", "))
    checked(SLED, initial={name: float(value) for name, value in pairs})


def test_a_goal_inside_of_another_body() -> None:
    there = {"ball.x": 1, "ball.y": 0.05, "ball.angle": 0, "arm.angle": 0}
    issue = refused(ARM, final=there)
    assert issue.pointer == "/phases/0/final"
    assert issue.message == "'tip' ends 0.05 m inside of 'round'"


def test_a_joint_beyond_its_limits_that_is_no_coordinate() -> None:
    issue = refused(ARM, initial={"arm.angle": 1.5})
    assert issue.pointer == "/phases/0/system/joints/shoulder/limits"
    assert issue.message == "'shoulder' misses the limits of its joint by 0.5"


def test_lengths_that_the_solver_chooses_are_let_pass() -> None:
    contacts = {"toe": {"body": "sled", "at": [0, "-leg"]}}
    checked(
        {**SLED, "contacts": contacts},
        initial={**LEVEL, "sled.y": 0.1},
        static={"leg": {"bounds": [0.05, 0.3], "guess": 0.2}},
    )


STANDING = {"base.x": 0, "base.y": 0, "base.qw": 1, "base.qx": 0, "base.qy": 0, "base.qz": 0}


def test_a_box_in_space_inside_of_the_ground() -> None:
    corners = {name: {"link": "box", "at": [x, 0, -0.1]} for name, x in (("a", 0.2), ("b", -0.2))}
    system = {"kind": "urdf", "text": robot(link("box")), "base": "floating", "contacts": corners}
    checked(system, initial={**STANDING, "base.z": 0.1})
    checked(system, initial={"base.z": 0.05})
    issue = refused(system, initial={**STANDING, "base.z": 0.05})
    assert issue.pointer == "/phases/0/initial"
    assert issue.message == "'a' starts 0.05 m inside of the ground"
    assert issue.hint == "the same pose is clear at base.z = 0.1"
    turned = {**STANDING, "base.qw": "cos(0.25)", "base.qy": "sin(0.25)", "base.z": 0.1}
    depth = 0.1 * (math.cos(0.5) - 1) + 0.2 * math.sin(0.5)
    assert f"ends {depth:.4g} m inside" in refused(system, final=turned).message


def test_a_robot_on_a_stand_inside_of_the_ground() -> None:
    system = {
        "kind": "urdf",
        "text": PENDULUM,
        "contacts": {"tip": {"link": "bob", "at": [0, 0, -1]}},
    }
    issue = refused(system, initial={"hinge": 0})
    assert issue.message == "'tip' starts 1 m inside of the ground"
    assert issue.hint.startswith("move a joint")


def test_other_methods_are_not_concerned() -> None:
    checked(SLED, "radau", final={**LEVEL, "sled.y": 0.1})
