"""What roboticists write out of habit is answered with how it is said here."""

from typing import Any

import pytest

from schemas.errors import Issue
from schemas.habits import as_rate
from schemas.reading import read_problem
from tests.support.problems import changed, hop, issues

STANCE = "phases 0 system"


def only(path: str, value: Any) -> Issue:
    (issue,) = issues(changed(path, value, hop() | {"stages": []}))
    return issue


@pytest.mark.parametrize(
    ("word", "mend"),
    [("qdot", "write d(q)"), ("dq", "write d(q)"), ("q_ddot", "write dd(q)"), ("w", ""),
     ("ddq", "write dd(q)"), ("dddq", "write ddd(q)"), ("q2_dot", "write d(q2)"), ("dot", "")],
)  # fmt: skip
def test_rates_in_other_spellings(word: str, mend: str) -> None:
    assert as_rate(word, ["q", "q2"]) == mend


@pytest.mark.parametrize(
    ("path", "value", "hint"),
    [
        (f"{STANCE} accelerations x", "-ydot", "write d(y)"),
        ("phases 0 initial", {"dx": 0}, "write d(x)"),
        ("linkages 0 expression", "flight.h", "write flight.initial.h or flight.final.h"),
        (f"{STANCE} parameters m", "2*k", "the solver chooses 'k': move this to 'define'"),
        ("phases 0 initial", {"x": "k"}, "the solver chooses 'k': write a constraint"),
        ("phases 0 final", {"x": "2*y"}, "the solver chooses 'y': write a constraint"),
        ("phases 2 system residual", ["d(y) - f"], "write the equations of motion"),
    ],
)
def test_what_stands_in_the_wrong_place(path: str, value: Any, hint: str) -> None:
    assert only(path, value).hint.startswith(hint)


@pytest.mark.parametrize("form", ["a - f", "final_force", "d(w) - f"])
def test_accelerations_may_come_in_by_an_intermediate(form: str) -> None:
    define = {"a": "2*dd(y)", "w": "d(y)", "final_force": "a - f"}
    problem = changed("phases 2 system define", define, hop() | {"stages": []})
    assert read_problem(changed("phases 2 system residual", [form], problem)).phases
