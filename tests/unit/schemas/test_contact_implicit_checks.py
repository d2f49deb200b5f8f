"""What contact-implicit methods refuse, and what of a good problem they remark on."""

import copy
from typing import Any

import pytest

from schemas.errors import BadProblem, Issue
from schemas.reading import read_problem
from schemas.remarks import remarks
from tests.support.problems import cart_pole
from tests.support.robots import PENDULUM, joint, link, robot

Document = dict[str, Any]

SLED = {
    "kind": "mechanism",
    "bodies": {"sled": {"mass": 1, "inertia": 0.1}},
    "joints": {"free": {"kind": "floating", "child": "sled"}},
    "contacts": {
        "heel": {"body": "sled", "at": [-0.5, -0.2]},
        "toe": {"body": "sled", "at": [0.5, -0.2]},
    },
    "controls": ["u"],
    "forces": {"push": {"body": "sled", "at": [0, 0], "direction": [1, 0], "value": "u"}},
}
ARM = {
    "kind": "mechanism",
    "bodies": {"arm": {"mass": 1, "inertia": 0.1, "com": [0.5, 0]}},
    "joints": {"shoulder": {"kind": "revolute", "child": "arm"}},
    "motors": {"drive": {"joint": "shoulder"}},
}
FOOT = {"link": "bob", "at": [0, 0, -1]}


def problem(path: str = "", value: Any = None, *, system: Document | None = None) -> Document:
    """A sled that may slide, or another system; one place of the document changed."""
    document: Document = {
        "phases": [
            {
                "name": "slide",
                "system": copy.deepcopy(system or SLED),
                "time": {"final": 1},
                "integrals": {"effort": "1"},
            }
        ],
        "method": {"kind": "contact_implicit"},
        "objective": {"minimize": "effort"},
    }
    if path:
        place: Any = document
        *parts, last = path.split("/")
        for part in parts:
            place = place[int(part)] if isinstance(place, list) else place.setdefault(part, {})
        place[last] = value
    return document


def refused(document: Document) -> Issue:
    with pytest.raises(BadProblem) as caught:
        read_problem(document)
    (issue,) = caught.value.issues
    return issue


def polished(document: Document) -> Document:
    return {**document, "method": {"kind": "contact_implicit_polished"}}


def urdf(**more: Any) -> Document:
    return {"kind": "urdf", "text": PENDULUM, "contacts": {"foot": FOOT}, **more}


@pytest.mark.parametrize(
    "document",
    [
        problem(),
        polished(problem()),
        problem(system=urdf()),
        problem("phases/0/periodic", {"free": ["sled.x"]}),
        problem("phases/0/system/surfaces", {"ground": {"restitution": 0}}),
        problem("method/discretisation", "backward_euler"),
        problem("method/steps", "pairwise"),
        problem("method/steps", "fixed"),
        problem("phases/0/integrals/effort", "abs(u*sled.vx) + contact.toe.normal^2"),
        problem("phases/0/integrals/effort", "sled.d(x)^2 + toe.vy + toe.d(y) + energy.total"),
        problem("phases/0/path", [{"name": "up", "expression": "com.vy", "upper": 2}]),
    ],
)
def test_problems_that_can_be_stepped_are_let_pass(document: Document) -> None:
    assert read_problem(document).method.kind.startswith("contact_implicit")


@pytest.mark.parametrize("kind", ["contact_implicit", "contact_implicit_polished"])
def test_systems_that_nothing_touches(kind: str) -> None:
    issue = refused({**cart_pole(), "method": {"kind": kind}})
    assert issue.pointer == "/method/kind"
    assert f"{kind} is for mechanisms and urdf systems" in issue.message
    assert issue.message.endswith("'swing_up' is an ode")
    assert "hermite_simpson" in issue.hint


def test_a_flight_in_closed_form_takes_no_method() -> None:
    flight = {
        "name": "flight",
        "system": {"kind": "closed_form", "states": {"x": "initial.x"}},
        "time": {"duration": 1},
    }
    document = problem()
    document["phases"].append(flight)
    del document["objective"]
    assert len(read_problem(document).phases) == 2


@pytest.mark.parametrize(
    ("path", "value", "place", "message", "hint"),
    [
        ("phases/0/system/mode", {"toe": "sticking"}, "phases/0/system/mode", "finds what", "away"),
        ("method/step_bounds", [0, 2], "method/step_bounds", "0 to 2 times", "above 0"),
        ("method/step_bounds", [1.1, 2], "method/step_bounds", "1.1 to 2 times", "at most 1"),
        ("method/step_bounds", [0.5, 0.9], "method/step_bounds", "0.5 to 0.9", "at least 1"),
        ("method/step_bounds", [2, 0.5], "method/step_bounds", "2 to 0.5", "at least 1"),
        (
            "phases/0/periodic",
            {"free": ["sled.x"], "impact": {"lands": ["toe"]}},
            "phases/0/periodic/impact",
            "a step like any other",
            "take 'impact' away",
        ),
        (
            "phases/0/system/surfaces",
            {"ground": {"restitution": 0.5}},
            "phases/0/system/surfaces/ground/restitution",
            "of 'ground' is of 0.5",
            "hybrid",
        ),
        (
            "phases/0/system/pairs",
            {"kick": {"contact": "toe", "against": "ground", "restitution": 0.3}},
            "phases/0/system/pairs/kick/restitution",
            "of 'kick' is of 0.3",
            "simulated",
        ),
        (
            "phases/0/system/contacts/sole",
            {"body": "sled", "at": ["1/2", -0.2]},
            "phases/0/system/contacts/sole",
            "'toe' and 'sole' are the same place of 'sled', and both may touch 'ground'",
            "keep one",
        ),
    ],
)
def test_what_is_refused(path: str, value: Any, place: str, message: str, hint: str) -> None:
    for document in (problem(path, value), _within_polished(path, value)):
        issue = refused(document)
        kept = document["method"]["kind"] == "contact_implicit"
        assert issue.pointer == f"/{place if kept else place.replace('method/', 'method/steps/')}"
        assert message in issue.message
        assert hint in issue.hint


def _within_polished(path: str, value: Any) -> Document:
    document = problem() if path.startswith("method/") else problem(path, value)
    steps: Document = {"kind": "contact_implicit"}
    if path.startswith("method/"):
        steps[path.removeprefix("method/")] = value
    document["method"] = {"kind": "contact_implicit_polished", "steps": steps}
    return document


def test_switches_are_for_the_polish_alone() -> None:
    issue = refused(problem("refinement/switches", True))
    assert issue.pointer == "/refinement/switches"
    assert "when contacts change" in issue.message
    read_problem(polished(problem("refinement/switches", True)))


def test_loose_forces_are_variables_like_all() -> None:
    pin = {"between": [{"body": "ground"}, {"body": "arm"}]}
    document = problem("phases/0/system/loops", {"pin": pin}, system=ARM)
    document["phases"][0]["system"]["loose"] = ["loop.pin.x"]
    issue = refused(document)
    assert issue.pointer == "/phases/0/system/loose"
    assert "all forces of contacts and loops are variables" in issue.message


def test_restitution_of_what_no_pair_touches_is_let_pass() -> None:
    document = problem("phases/0/system/surfaces", {"ice": {"restitution": 1}, "sand": {}})
    document["phases"][0]["system"]["pairs"] = {"one": {"contact": "toe", "against": "sand"}}
    assert read_problem(document).phases


def test_restitution_that_the_solver_chooses() -> None:
    document = problem("static/e", {"bounds": [0, 1]})
    document["phases"][0]["system"]["surfaces"] = {"ground": {"restitution": "e"}}
    assert "chosen by the solver" in refused(document).message


@pytest.mark.parametrize(
    ("time", "fixed"),
    [
        ({"final": [0.5, 1]}, False),
        ({"duration": [0.5, 1]}, False),
        ({"initial": [0, 1], "final": 2}, False),
        ({"initial": 1, "final": [None, None]}, False),
        ({"initial": [0, 1], "duration": 2}, True),
        ({"initial": 1, "final": 3}, True),
        ({"final": 0.3, "duration": [0.1, 5]}, True),
    ],
)
def test_fixed_steps_need_a_fixed_time(time: Document, *, fixed: bool) -> None:
    document = problem("phases/0/time", time)
    document["method"]["steps"] = "fixed"
    if fixed:
        assert read_problem(document).phases
        return
    issue = refused(document)
    assert issue.pointer == "/method/steps"
    assert "the length of the phase 'slide' is free" in issue.message


def test_pairwise_steps_are_even() -> None:
    document = problem("method/steps", "pairwise")
    document["method"]["segments"] = 15
    issue = refused(document)
    assert issue.pointer == "/method/segments"
    assert issue.hint == "take 16 segments"


def test_the_phase_s_own_method_is_pointed_at() -> None:
    document = problem("phases/0/method", {"kind": "contact_implicit", "step_bounds": [0, 1]})
    del document["method"]
    assert refused(document).pointer == "/phases/0/method/step_bounds"


def test_a_shared_method_is_refused_once() -> None:
    document = problem("method/step_bounds", [0, 1])
    document["phases"].append({**document["phases"][0], "name": "again", "time": {"duration": 1}})
    del document["objective"]
    assert refused(document).pointer == "/method/step_bounds"


def test_one_relaxation_for_all_phases() -> None:
    document = problem()
    own = {"kind": "contact_implicit", "relaxation": {"form": "inequality"}}
    again = {"name": "again", "time": {"duration": 1}, "method": own}
    document["phases"].append({**document["phases"][0], **again})
    del document["objective"]
    issue = refused(document)
    assert issue.pointer == "/phases/1/method/relaxation"
    assert "phase 'slide'" in issue.message


def test_no_polish_in_space() -> None:
    method = {"kind": "contact_implicit_polished"}
    issue = refused({**problem(system=urdf()), "method": method})
    assert issue.pointer == "/method/kind"
    assert "mechanisms in the plane" in issue.message


@pytest.mark.parametrize("way", ["discrete_gradient", "backward_euler"])
def test_both_kinds_of_steps_in_space(way: str) -> None:
    method = {"kind": "contact_implicit", "discretisation": way}
    assert read_problem({**problem(system=urdf()), "method": method}).phases


def test_coincident_contacts_of_a_link() -> None:
    feet = {"foot": FOOT, "ball": {**FOOT, "radius": 0.1}, "sole": FOOT}
    issue = refused(problem(system=urdf(contacts=feet)))
    assert issue.pointer == "/phases/0/system/contacts/sole"
    assert "'foot' and 'sole' are the same place of 'bob'" in issue.message


def test_contacts_at_one_place_by_a_weld() -> None:
    document = problem("phases/0/system/bodies/plate", {"mass": 1, "inertia": 0.1})
    system = document["phases"][0]["system"]
    system["joints"]["weld"] = {
        "kind": "welded", "parent": "sled", "child": "plate",
        "at": [0.5, 0.8], "to": [1, 0], "angle": "pi/2",
    }  # fmt: skip
    system["contacts"]["tip"] = {"body": "plate", "at": [0, 0]}
    system["contacts"]["end"] = {"body": "plate", "at": [1, 0]}
    issue = refused(document)  # the plate's origin is 1 m below the weld, at the toe
    assert issue.pointer == "/phases/0/system/contacts/tip"
    assert "'toe' and 'tip' are the same place of 'sled'" in issue.message
    system["joints"]["weld"]["angle"] = 1.5
    assert read_problem(document).phases


@pytest.mark.parametrize(
    ("expression", "needs"),
    [
        ("sled.dd(x)^2", "sled.dd(x)"),
        ("sled.d(vx)", "sled.d(vx)"),
        ("sled.dddd(angle)", "sled.dddd(angle)"),
        ("com.d(vx)", "com.d(vx)"),
        ("toe.dd(y)", "toe.dd(y)"),
        ("d(u)^2", "d(u)"),
        ("contact.toe.d(normal)", "contact.toe.d(normal)"),
        ("energy.d(kinetic)", "energy.d(kinetic)"),
        ("jerk", "jerk needs sled.ddd(x)"),
        ("d(speed)", "d(speed) needs sled.dd(x)"),
    ],
)
def test_derivatives_that_steps_do_not_have(expression: str, needs: str) -> None:
    document = problem("phases/0/integrals/effort", f"1 + {expression}")
    document["phases"][0]["system"]["define"] = {"speed": "sled.d(x)"}
    if expression == "jerk":
        document["phases"][0]["system"]["define"]["jerk"] = "sled.ddd(x)"
    found = _issues(document)
    assert {issue.pointer for issue in found} >= {"/phases/0/integrals/effort"}
    assert any(needs in issue.message for issue in found)
    assert all("velocities jump at impacts" in issue.message for issue in found)


def _issues(document: Document) -> list[Issue]:
    with pytest.raises(BadProblem) as caught:
        read_problem(document)
    return caught.value.issues


def test_bounds_of_accelerations() -> None:
    issue = refused(problem("phases/0/bounds", {"sled.dd(x)": [-1, 1]}))
    assert issue.pointer == "/phases/0/bounds/sled.dd(x)"


def test_forces_over_accelerations() -> None:
    issue = refused(problem("phases/0/system/forces/push/value", "u - 0.1*sled.dd(x)"))
    assert issue.pointer == "/phases/0/system/forces/push/value"
    assert issue.column == 9


@pytest.mark.parametrize(
    ("bound", "final", "time"),
    [
        ([-1, 1], 2, {"final": 1.5}),
        ([-3, 1], 2, {"final": [0.1, 1.9]}),
        ([-1, 0.5], -2.5, {"duration": 2}),
    ],
)
def test_ends_out_of_reach_in_time(bound: list[float], final: float, time: Document) -> None:
    document = problem("phases/0/bounds", {"sled.d(x)": bound})
    document["phases"][0] |= {"initial": {"sled.x": 0}, "final": {"sled.x": final}, "time": time}
    issue = refused(document)
    assert issue.pointer == "/phases/0/final/sled.x"
    assert "all the time there is" in issue.message


@pytest.mark.parametrize("final", [1.5, -1.5, [1, 9]])
def test_ends_in_reach_are_let_pass(final: Any) -> None:
    document = problem("phases/0/bounds", {"sled.d(x)": [-1, 1]})
    own = {"initial": {"sled.x": 0}, "final": {"sled.x": final}, "time": {"final": [0.1, 1.5]}}
    document["phases"][0] |= own
    assert read_problem(document).phases


@pytest.mark.parametrize("kind", ["contact_implicit", "radau"])
def test_ends_beyond_a_joint_s_limits(kind: str) -> None:
    document = problem("phases/0/final", {"shoulder": 3}, system=ARM)
    document["phases"][0]["system"]["joints"]["shoulder"]["limits"] = [-1, "pi/2"]
    document["method"] = {"kind": kind}
    issue = refused(document)
    assert issue.pointer == "/phases/0/final/shoulder"
    assert issue.message == "3 is 1.429 beyond the limit of the joint 'shoulder', 1.5708"
    assert "the nearest is 1.5708" in issue.hint


def told(document: Document) -> list[str]:
    return list(remarks(read_problem(document)))


def test_collocation_is_better_where_nothing_touches() -> None:
    (line,) = told(problem(system=ARM))
    assert line.startswith("/method: nothing touches or stops in the phase 'slide'")
    stopped = problem("phases/0/system/joints/shoulder/limits", [-1, 1], system=ARM)
    assert not told(stopped)
    stopped["method"]["stops"] = False
    assert len(told(stopped)) == 1
    assert not told(problem())


def test_a_load_on_three_points_of_a_line() -> None:
    middle: Document = {"body": "sled", "at": [0.1, -0.2]}
    document = problem("phases/0/system/contacts/middle", middle)
    (line,) = told(document)
    assert line.startswith("/phases/0/system/contacts/middle: 'heel', 'toe' and 'middle' bear")
    for height, found in (("0.2*x", 1), ("x^2", 0), ("sin(x)", 0)):
        document["phases"][0]["system"]["surfaces"] = {"ground": {"height": height}}
        assert len(told(document)) == found
    middle["at"] = [0.1, -0.19]
    assert not told(problem("phases/0/system/contacts/middle", middle))
    assert not told(problem("phases/0/system/contacts/middle", {**middle, "radius": 0.1}))


def test_a_load_on_four_corners() -> None:
    corners: Document = {
        name: {"link": "box", "at": [x, y, 0]}
        for name, x, y in (("a", 1, 1), ("b", 1, -1), ("c", -1, 1), ("d", -1, -1))
    }
    text = robot(link("box", com="0 0 0.5"))
    system = {"kind": "urdf", "text": text, "base": "floating", "contacts": corners}
    assert any("'a', 'b', 'c' and 'd' bear" in line for line in told(problem(system=system)))
    corners["d"]["at"][2] = 0.1
    assert not any("bear" in line for line in told(problem(system=system)))


def test_long_steps() -> None:
    document = problem("phases/0/time", {"final": [8, 10]})
    (line,) = told(document)
    assert line.startswith("/method/segments: steps of 0.4 s, in which a body falls 0.78 m")
    document["method"]["segments"] = 40
    assert not told(document)


def test_two_feet_of_two_links_are_not_one() -> None:
    text = robot(link("a"), link("b"), joint("j", "continuous", "a", "b"))
    feet = {"one": {"link": "a"}, "two": {"link": "b"}}
    assert read_problem(problem(system={"kind": "urdf", "text": text, "contacts": feet})).phases
