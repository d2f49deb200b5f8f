"""What is wrong with a sequence of modes is told at its place in the posted problem."""

import copy
from typing import Any

import pytest

import examples
from schemas.errors import BadProblem, InvalidModel, Issue
from schemas.reading import read_problem
from solver.pipeline import solve

HOPPER = examples.load("hopper_hybrid")


def hopper(*durations: Any, final: Any = None) -> dict[str, Any]:
    """The hopper, its first modes of the given durations."""
    given = copy.deepcopy(HOPPER)
    for mode, duration in zip(given["method"]["sequence"], durations, strict=False):
        mode["duration"] = duration
    if final is not None:
        given["phases"][0]["time"]["final"] = final
    return given


def refused(given: dict[str, Any]) -> Issue:
    with pytest.raises(BadProblem) as caught:
        read_problem(given)
    (issue,) = caught.value.issues
    return issue


@pytest.mark.parametrize(
    ("durations", "final", "mode", "words"),
    [
        ([[-2, -1]], None, 0, "cannot last"),
        ([[0.1, 0.5], [0.5, 0.2]], None, 1, "above the upper"),
        ([[0.1, 0.2], [5, 6]], None, 1, "together at the least, the phase 2 s at the most"),
        ([0.01, 0.02, 0.03], None, 0, "0.06 s together at the most, the phase 0.3 s at the least"),
        ([0.1, 0.2, 0.3], 0.5, 2, "0.6 s together at the least, the phase 0.5 s at the most"),
        (["missing"], None, 0, "not a constant"),
    ],
)
def test_durations_of_modes(durations: list[Any], final: Any, mode: int, words: str) -> None:
    issue = refused(hopper(*durations, final=final))
    assert issue.pointer == f"/method/sequence/{mode}/duration"
    assert words in issue.message


@pytest.mark.parametrize("final", [0.6, [0.1, 0.6], 0.1 + 0.2 + 0.3])
def test_durations_that_fill_the_phase_are_let_pass(final: Any) -> None:
    assert read_problem(hopper(0.1, 0.2, 0.3, final=final)).method.kind == "hybrid"


def test_the_phase_s_own_method_is_pointed_at() -> None:
    given = hopper([-2, -1])
    given["phases"][0]["method"] = given.pop("method")
    assert refused(given).pointer == "/phases/0/method/sequence/0/duration"


def test_a_sequence_has_a_mode() -> None:
    given = hopper()
    given["method"]["sequence"] = []
    issue = refused(given)
    assert issue.pointer == "/method/sequence"
    assert issue.message == "expected one entry or more, got none"


@pytest.mark.parametrize("own", [True, False])
def test_a_contact_out_of_reach_is_one_of_the_sequence(own: bool) -> None:
    given = hopper()
    phase = given["phases"][0]
    phase["initial"]["height"] = [3, 4]
    phase["bounds"]["height"] = [0, 5]
    if own:
        phase["method"] = given.pop("method")
    with pytest.raises(InvalidModel) as caught:
        solve(read_problem(given))
    (issue,) = caught.value.issues
    place = "/phases/0/method" if own else "/method"
    assert issue.pointer == f"{place}/sequence/0/contacts/foot"
