"""Mechanisms as data: what is read, and what is refused, at its place and with the mend."""

import copy
from typing import Any

import pytest

from schemas.errors import BadProblem, Issue
from schemas.mechanisms import Mechanism
from schemas.reading import canonical, read_problem
from schemas.remarks import remarks
from tests.support.machines import Build, cart_pole, chain, crane, double_pendulum, rolling

LIMB = {"mass": 1, "inertia": 0.1, "com": [0, -0.2]}


def leg() -> dict[str, Any]:
    """A trunk on a slider, a leg with a foot, a motor, a spring, two contacts, a ball."""
    return {
        "kind": "mechanism",
        "parameters": {"m": 2.0, "zero": 0.0},
        "bodies": {name: copy.deepcopy(LIMB) for name in ("trunk", "thigh", "shank", "ball")},
        "joints": {
            "rail": {"kind": "prismatic", "child": "trunk", "axis": [0, 1]},
            "hip": {"kind": "revolute", "parent": "trunk", "child": "thigh"},
            "knee": {"kind": "revolute", "parent": "thigh", "child": "shank", "at": [0, -0.4]},
            "free": {"kind": "floating", "child": "ball"},
        },
        "points": {"tip": {"body": "shank", "at": [0, -0.4]}},
        "motors": {"hip": {"joint": "hip"}, "knee": {"joint": "knee", "losses": {"constant": 2}}},
        "springs": {"knee": {"joint": "knee", "stiffness": 3}},
        "controls": ["push"],
        "define": {"reach": "tip.x - trunk.x", "fast": "d(reach)"},
        "forces": {"push": {"body": "trunk", "at": [0, 0], "direction": [1, 0], "value": "push"}},
        "torques": {"hip": {"joint": "hip", "value": "-0.1*d(hip)"}},
        "contacts": {"toe": {"body": "shank", "at": [0, -0.4]}},
        "surfaces": {"ground": {"height": "0.1*sin(x)"}},
        "shapes": {"ball": {"body": "ball", "circle": 0.2}},
        "pairs": {
            "toe": {"contact": "toe", "against": "ground"},
            "kick": {"contact": "toe", "against": "ball", "friction": 0.3},
        },
    }


def document(system: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    phase = {"system": leg() if system is None else system, "time": {"final": 1}}
    phase["integrals"] = {"cost": "motor.hip.torque^2 + fast^2 + contact.toe.slip^2"}
    return {"phases": [phase], "objective": {"minimize": "cost + final.com.vx"}, **more}


def refused(document: dict[str, Any]) -> list[Issue]:
    with pytest.raises(BadProblem) as error:
        read_problem(document)
    return error.value.issues


def changed(path: str, value: Any) -> dict[str, Any]:
    """The document with one place of the mechanism set, or taken away where the value is None."""
    given = document()
    *way, last = path.split("/")
    place = given["phases"][0]["system"]
    for part in way:
        place = place[int(part)] if isinstance(place, list) else place.setdefault(part, {})
    if value is None:
        del place[last]
    elif isinstance(place, list):
        place[int(last)] = value
    else:
        place[last] = value
    return given


def test_a_mechanism_is_read_and_written() -> None:
    problem = read_problem(document())
    again = read_problem(canonical(problem))
    assert canonical(again) == canonical(problem)
    assert not [line for line in remarks(problem) if "four-bar" in line]


@pytest.mark.parametrize("build", [chain, cart_pole, crane, double_pendulum, rolling])
def test_the_machines_of_the_tests_are_good(build: Build) -> None:
    system = build().model_dump(mode="json")
    read_problem({"phases": [{"system": system, "time": {"final": 1}}]})


REFUSED = {
    "a mass of zero": ("bodies/thigh/mass", "zero", "bodies/thigh/mass", "above 0"),
    "a negative mass": ("bodies/thigh/mass", "-m", "bodies/thigh/mass", "is -2"),
    "a negative inertia": ("bodies/thigh/inertia", -1, "bodies/thigh/inertia", "above 0"),
    "no inertia": ("bodies/thigh", {"mass": 1}, "bodies/thigh/inertia", "no inertia"),
    "no mass": ("bodies/thigh", {"inertia": 1}, "bodies/thigh/mass", "no mass"),
    "a massless leaf": ("bodies/shank", {}, "bodies/shank", "no mass and carries none"),
    "no value": ("bodies/thigh/mass", "1/zero", "bodies/thigh/mass", "division by zero"),
    "an unknown parent": ("joints/knee/parent", "tigh", "joints/knee/parent", "no body 'tigh'"),
    "an unknown child": ("joints/knee/child", "shin", "joints/knee/child", "no body 'shin'"),
    "an unknown body of a point": ("points/tip/body", "foot", "points/tip/body", "no body"),
    "an unknown joint": ("motors/hip/joint", "hips", "motors/hip/joint", "no joint 'hips'"),
    "an unknown joint's torque": ("torques/hip/joint", "hop", "torques/hip/joint", "no joint"),
    "an unknown contact": ("pairs/toe/contact", "toes", "pairs/toe/contact", "no contact 'toes'"),
    "an unknown ground": ("pairs/toe/against", "rock", "pairs/toe/against", "surface or shape"),
    "an unknown pair": ("mode", {"heel": "sticking"}, "mode/heel", "no pair 'heel'"),
    "a loose force of nothing": ("loose", ["contact.toe.normal"], "loose/0", "no force that holds"),
    "an unknown kind": ("mode", {"toe": "stuck"}, "mode/toe", "'stuck' is none of"),
    "two joints": (
        "joints/again",
        {"kind": "revolute", "parent": "trunk", "child": "shank"},
        "joints/again/child",
        "hangs on the joint 'knee' already",
    ),
    "no joint": ("joints/free", None, "bodies/ball", "hangs on no joint"),
    "a circle": ("joints/hip/parent", "shank", "joints/hip/parent", "in a circle"),
    "a carried ground": ("joints/hip/child", "ground", "joints/hip/child", "carried by nothing"),
    "a joint named as a control": ("controls", ["hip"], "controls/0", "already the name"),
    "a joint that is reserved": (
        "joints/t",
        {"kind": "welded", "parent": "trunk", "child": "ball"},
        "joints/t",
        "reserved",
    ),
    "a point named as a body": ("points/thigh", {"body": "thigh"}, "points/thigh", "a body"),
    "a body named com": ("bodies/com", LIMB, "bodies/com", "reserved"),
    "a body named as its phase": ("points/phase", {"body": "thigh"}, "points/phase", "a phase"),
    "a shape named as a ground": (
        "shapes/ground",
        {"body": "ball", "circle": 1},
        "shapes/ground",
        "a surface",
    ),
    "a motor on a floating joint": ("motors/hip/joint", "free", "motors/hip/joint", "floating"),
    "a gear of zero": ("motors/hip/gear", 0, "motors/hip/gear", "does nothing"),
    "a gear beside losses": ("motors/knee/gear", 50, "motors/knee/gear", "in their constants"),
    "a current without losses": ("motors/hip/current", [0, 1], "motors/hip/current", "no current"),
    "losses below zero": (
        "motors/knee/losses/viscous",
        -1,
        "motors/knee/losses/viscous",
        "not be below 0",
    ),
    "limits swapped": ("joints/hip/limits", [1, -1], "joints/hip/limits", "above the upper"),
    "limits of names": ("joints/hip/limits", [0, "many"], "joints/hip/limits/1", "not a constant"),
    "an axis of no length": ("joints/rail/axis", [0, "zero"], "joints/rail/axis", "no length"),
    "a direction of none": ("forces/push/direction", [0, 0], "forces/push/direction", "no length"),
    "a negative stiffness": ("springs/knee/stiffness", -1, "springs/knee/stiffness", "below 0"),
    "friction below zero": ("pairs/kick/friction", -0.1, "pairs/kick/friction", "below 0"),
    "a bouncy ground": (
        "surfaces/ground/restitution",
        1.5,
        "surfaces/ground/restitution",
        "restitution of 1.5",
    ),
    "a radius below zero": ("contacts/toe/radius", -1, "contacts/toe/radius", "below 0"),
    "a circle of nothing": ("shapes/ball/circle", 0, "shapes/ball/circle", "above 0"),
    "both shapes": ("shapes/ball/ellipse", [1, 1], "shapes/ball", "either 'circle' or 'ellipse'"),
    "its own shape": ("contacts/toe/body", "ball", "pairs/kick", "of the same body"),
    "a step by sign": ("surfaces/ground/height", "sign(x)", "surfaces/ground/height", "step"),
    "a step of another kind": (
        "surfaces/ground/height",
        "0.2*atan(1/(x - 3))",
        "surfaces/ground/height",
        "vertical step at x = 3",
    ),
    "a pole": ("surfaces/ground/height", "1/x", "surfaces/ground/height", "end near x = 0"),
    "a corner of three": (
        "bodies/thigh/outline",
        [[0, 0], [0, 0, 0]],
        "bodies/thigh/outline/1",
        "x and y, got a list of 3",
    ),
    "a corner of none": ("bodies/thigh/outline", [[]], "bodies/thigh/outline/0", "a list of 0"),
    "a body called ground": ("bodies/ground", LIMB, "bodies/ground", "reserved"),
    "a height over time": ("surfaces/ground/height", "0.1*t", "surfaces/ground/height", "'t'"),
    "a mass over time": ("bodies/thigh/mass", "1 + t", "bodies/thigh/mass", "unknown name 't'"),
    "a place over coordinates": ("joints/knee/at/1", "-hip", "joints/knee/at/1", "'hip'"),
    "a force of jerk": ("forces/push/value", "ddd(hip)", "forces/push/value", "ddd(hip)"),
    "an unknown name": ("forces/push/value", "thig.x", "forces/push/value", "unknown name"),
    "one place": (
        "loops/pin",
        {"between": [{"body": "ball"}]},
        "loops/pin/between",
        "2 entries or more",
    ),
    "a loop of one body": (
        "loops/pin",
        {"between": [{"body": "ball"}, {"body": "ball", "at": [1, 0]}]},
        "loops/pin/between",
        "both places are of 'ball'",
    ),
    "a spring of two kinds": (
        "springs/knee/between",
        [{"body": "ball"}, {"body": "trunk"}],
        "springs/knee",
        "either 'joint' or 'between'",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_it_is_refused_at_its_place(what: str) -> None:
    path, value, place, words = REFUSED[what]
    issues = refused(changed(path, value))
    told = [issue.message for issue in issues if issue.pointer == f"/phases/0/system/{place}"]
    assert any(words in message for message in told), [str(issue) for issue in issues]


@pytest.mark.parametrize(
    ("path", "value", "mend"),
    [
        ("joints/knee/parent", "tigh", "did you mean 'thigh'?"),
        ("motors/hip/joint", "hips", "did you mean 'hip'?"),
        ("joints/again", {"kind": "revolute", "parent": "trunk", "child": "shank"}, "'loops'"),
        ("joints/free", None, '{"kind": "floating", "child": "ball"}'),
        ("surfaces/ground/height", "0.1*sign(x - 2)", "such as 0.1*tanh((x - 2)/0.01),"),
        ("surfaces/ground/height", "0.3*x/abs(x)", "such as 0.3*tanh(x/0.01),"),
        ("surfaces/ground/height", "1/(x - 3)", "away from 0"),
        ("surfaces/ground/height", "t*x", "the ground does not move"),
        ("surfaces/ground/height", "hip", "the ground does not move"),
        ("bodies/thigh/mass", "1 kg", "units are SI and left out: write 1;"),
        ("forces/push/value", "tip.xx", "did you mean 'tip.x'?"),
        ("mode", {"toes": "sticking"}, "did you mean 'toe'?"),
        ("mode", {"toe": "stuck"}, "write 'sticking'"),
        ("joints/hip/kind", "hinge", "write 'revolute'"),
        ("joints/rail/kind", "slider", "write 'prismatic'"),
        ("gravity", 9.81, "write x and y, such as [0, -9.81]"),
        ("gravity", [0, 0, -9.81], "write x and y, such as [0, -9.81]"),
        ("bodies/thigh/com", [1], "write x and y, such as [0, -9.81]"),
        ("motors/hip/torque", 5, "write [-5.0, 5.0]"),
        ("joints/hip/limits", 2, "write [-2.0, 2.0]"),
    ],
)
def test_the_mend_is_told(path: str, value: Any, mend: str) -> None:
    assert any(mend in issue.hint for issue in refused(changed(path, value)))


@pytest.mark.parametrize(
    ("path", "value", "place"),
    [
        ("joints/hip/parent", "trnk", "joints/hip/parent"),
        ("joints/hip/child", "thih", "joints/hip/child"),
        ("joints/hip/parent", "shank", "joints/hip/parent"),
        ("joints/free", None, "bodies/ball"),
        ("bodies/ground", LIMB, "bodies/ground"),
    ],
)
def test_of_bodies_that_do_not_hang_together_the_cause_alone_is_named(
    path: str, value: Any, place: str
) -> None:
    given = changed(path, value)
    given["phases"][0] |= {
        "initial": {"hip": 0, "d(knee)": 0, "ball.x": 0},
        "bounds": {"hip": [0, 1], "tip.x": [0, 1]},
    }
    (issue,) = refused(given)
    assert issue.pointer == f"/phases/0/system/{place}"


def test_angles_that_look_like_degrees_are_remarked_on() -> None:
    given = changed("joints/hip/limits", [-90, "pi"])
    given["phases"][0] |= {
        "initial": {"hip": -45, "ball.angle": 30, "rail": 100, "knee": -12},
        "bounds": {"knee": [-60, 0], "thigh.angle": [None, "90*pi/180"]},
    }
    told = [text for text in remarks(read_problem(given)) if "looks like degrees" in text]
    assert [text.partition(":")[0] for text in told] == [
        "/phases/0/system/joints/hip/limits",
        "/phases/0/bounds/knee",
        "/phases/0/initial/hip",
        "/phases/0/initial/ball.angle",
    ]


def test_motors_that_share_a_joint_are_remarked_on() -> None:
    given = changed("motors/second", {"joint": "hip"})
    (told,) = remarks(read_problem(given))
    assert told.startswith("/phases/0/system/motors/second/joint: 'hip' drives")
    assert not list(remarks(read_problem(document())))


def test_every_mechanism_of_several_phases_is_checked() -> None:
    given = document()
    given["phases"].append(copy.deepcopy(given["phases"][0]) | {"name": "second"})
    given["phases"][0]["name"] = "first"
    given["phases"][1]["time"] = {"duration": 1}
    given["phases"][1]["system"]["bodies"]["thigh"]["mass"] = 0
    given["objective"] = {"minimize": "first.final.thigh.x"}
    del given["phases"][1]["integrals"], given["phases"][0]["integrals"]
    assert [issue.pointer for issue in refused(given)] == ["/phases/1/system/bodies/thigh/mass"]


@pytest.mark.parametrize(
    ("name", "good"),
    [
        ("tip.x", True),
        ("tip.dddd(x)", True),
        ("tip.ddd(vx)", True),
        ("tip.dddd(vx)", False),
        ("contact.toe.normal", True),
        ("contact.toe.dd(normal)", True),
        ("contact.toe.ddd(normal)", False),
        ("motor.hip.d(torque)", True),
        ("ball.angle", True),
        ("hip", True),
        ("motor.knee.current", True),
        ("loop.pin.x", False),
    ],
)
def test_names_have_as_many_derivatives_as_they_can(name: str, good: bool) -> None:
    given = document()
    given["phases"][0]["bounds"] = {name: [-1, 1]}
    given["phases"][0]["path"] = [{"name": "row", "expression": name, "upper": 1}]
    if good:
        read_problem(given)
    else:
        pointers = {issue.pointer for issue in refused(given)}
        assert {f"/phases/0/bounds/{name}", "/phases/0/path/0/expression"} <= pointers


def test_dircol5i_takes_mechanisms_without_held_contacts() -> None:
    method = {"kind": "dircol5i", "segments": 5}
    read_problem(document(method=method))
    system = leg() | {"mode": {"toe": "sticking"}}
    (issue,) = refused(document(system, method=method))
    assert issue.pointer == "/method/kind"
    assert "forces of contacts" in issue.message


def test_shooting_takes_forces_over_velocities_only() -> None:
    method = {"kind": "multiple_shooting"}
    read_problem(document(method=method))
    system = leg()
    system["forces"]["push"]["value"] = "0.1*dd(hip)"
    (issue,) = refused(document(system, method=method))
    assert issue.pointer == "/phases/0/system/forces/push/value"


def test_the_copy_forgets_what_followed_from_the_old_fields() -> None:
    old = Mechanism.model_validate(leg())
    assert "contact.toe.normal" in old.defined
    assert old.control_names == ["motor.hip.torque", "motor.knee.current", "push"]
    new = old.model_copy(update={"loose": ["contact.toe.normal"]})
    assert "contact.toe.normal" not in new.defined
    assert new.control_names[-1] == "contact.toe.normal"


def test_four_bars_that_fold_flat_are_remarked_on() -> None:
    def linkage(ground: float) -> dict[str, Any]:
        bars = {"crank": 0.4, "rod": 1.1, "rocker": 0.8}
        ends = [{"body": "rod", "at": ["rod", 0]}, {"body": "rocker", "at": ["rocker", 0]}]
        return {
            "kind": "mechanism",
            "parameters": {"rod": 1.1, "rocker": 0.8, "ground": ground},
            "bodies": dict.fromkeys(bars, LIMB),
            "joints": {
                "one": {"kind": "revolute", "child": "crank"},
                "two": {"kind": "revolute", "parent": "crank", "child": "rod", "at": [0.4, 0]},
                "three": {"kind": "revolute", "child": "rocker", "at": ["ground", 0]},
            },
            "loops": {"pin": {"between": ends}},
        }

    def lines(ground: float) -> list[str]:
        phase = {"system": linkage(ground), "time": {"final": 1}}
        return list(remarks(read_problem({"phases": [phase]})))

    (line,) = lines(0.7)  # 0.4 + 1.1 = 0.8 + 0.7
    assert line.startswith("/phases/0/system/loops/pin: a change-point four-bar")
    assert not lines(1.0)
