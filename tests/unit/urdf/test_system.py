"""URDF systems as clients post them."""

from typing import Any

import pytest

from schemas.errors import Issue
from schemas.reading import canonical, read_problem
from schemas.remarks import remarks
from tests.support.problems import issues
from tests.support.robots import LOOSE, PENDULUM, TREE

TEXT = "/phases/0/system/text"


def problem(text: str = TREE, **system: Any) -> dict[str, Any]:
    return {
        "name": "reach",
        "phases": [
            {
                "system": {"kind": "urdf", "text": text, **system},
                "time": {"final": 1},
                "integrals": {"effort": "motor.swing.torque^2"} if text == TREE else {},
            }
        ],
        "method": {"kind": "hermite_simpson", "segments": 5},
    }


def only(document: dict[str, Any]) -> Issue:
    found = issues(document)
    assert len(found) == 1, found
    return found[0]


def test_a_bad_text_is_told_at_its_place() -> None:
    issue = only(problem(TREE.replace('parent link="welded"', 'parent link="wedded"')))
    assert issue.pointer == TEXT
    assert "line 1: the parent of 'askew', 'wedded', is no link" in issue.message
    assert issue.hint == "did you mean 'welded'?"


def test_200_000_nested_tags_are_told_like_any_other() -> None:
    issue = only(problem("<robot>" + "<a>" * 200_000 + "</a>" * 200_000 + "</robot>"))
    assert issue.pointer == TEXT
    assert "nested over 32 deep" in issue.message
    assert issue.hint


@pytest.mark.parametrize(
    ("more", "place", "reason"),
    [
        ({"motors": ["swing", "swung"]}, "/motors/1", "the motor 'swung'"),
        ({"motors": ["follow"]}, "/motors/0", "mimics nobody"),
        ({"motors": ["swing", "swing"]}, "", "named twice"),
        ({"contacts": {"foot": {"link": "floor"}}}, "/contacts/foot/link", "the link of 'foot'"),
        ({"contacts": {"led": {"link": "led"}}}, "", "'led' is the name of a link"),
        ({"mode": {"foot": "sticking"}}, "/mode/foot", "'foot' in 'mode'"),
        (
            {
                "base": "floating",
                "contacts": {"heel": {"link": "swung"}, "toe": {"link": "welded"}},
                "mode": {"heel": "sticking", "toe": "sticking"},
            },
            "",
            "'heel' and 'toe' hold the same",
        ),
        (
            {"contacts": {"foot": {"link": "root"}}, "mode": {"foot": "sticking"}},
            "",
            "does not move",
        ),
    ],
)
def test_what_fields_name_must_be_there(more: dict[str, Any], place: str, reason: str) -> None:
    issue = only(problem(TREE, **more))
    assert issue.pointer == f"/phases/0/system{place}"
    assert reason in issue.message


def test_what_does_not_move_is_refused() -> None:
    still = PENDULUM.replace("continuous", "fixed")
    assert "nothing moves" in only(problem(still)).message
    assert read_problem(problem(still, base="floating")).phases[0].system.state_names


def test_links_may_not_take_the_names_of_the_language() -> None:
    assert "'com' is the name of a link" in only(problem(PENDULUM.replace("bob", "com"))).message
    above = PENDULUM.replace("bob", "base")
    assert "not the root" in only(problem(above, base="floating")).message
    assert read_problem(problem(above)).name == "reach"


def test_joints_may_not_take_reserved_names() -> None:
    issue = only(problem(PENDULUM.replace('"hinge"', '"sin"')))
    assert (issue.pointer, "reserved" in issue.message) == (TEXT, True)


def test_expressions_see_places_and_energies() -> None:
    document = problem(LOOSE, base="floating")
    path = [
        "free.x + base.norm",
        "dd(plane.u)",
        "com.d(z)",
        "energy.total",
        "loose.dd(qw)",
        "free.r33",
    ]
    path[1] = "plane.dd(u)"
    document["phases"][0]["path"] = [
        {"name": f"c{i}", "expression": one, "lower": -100} for i, one in enumerate(path)
    ]
    assert read_problem(document).name == "reach"
    document["phases"][0]["path"][0]["expression"] = "fre.x"
    assert "unknown name 'fre.x'" in only(document).message


def test_written_and_read_again_it_is_the_same() -> None:
    first = read_problem(problem(TREE, base="planar", motors=["swing"]))
    assert canonical(read_problem(canonical(first))) == canonical(first)


@pytest.mark.parametrize(
    ("field", "name", "value"),
    [("bounds", "swing", [2.5, 3]), ("initial", "swing", -2), ("bounds", "d(swing)", [4, None])],
)
def test_what_the_texts_limits_leave_no_room_for_is_refused(
    field: str, name: str, value: Any
) -> None:
    document = problem(TREE)
    document["phases"][0][field] = {name: value}
    issue = only(document)
    assert issue.pointer == f"/phases/0/{field}/{name}"
    assert "the text's own limits" in issue.message
    document["phases"][0]["system"]["limits"] = False
    assert read_problem(document).name == "reach"


def test_what_is_left_aside_is_told() -> None:
    drawn = TREE.replace("</link>", "<visual/></link>", 1)
    assert "/phases/0/system/text: 1 visual" in "\n".join(remarks(read_problem(problem(drawn))))
