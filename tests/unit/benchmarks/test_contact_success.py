"""What counts as success through contact, and that guesses differ."""

from dataclasses import replace

import pytest

from benchmarks.contact_success import CASES, Case, Ended, noisy, row, solved, succeeded

CASE = Case("finger", (3, 4), 0.15, 1.0)
GOOD = Ended("converged", 2.0, 1e-9, 0.5, "tip=sticking")


@pytest.mark.parametrize(
    "bad",
    [
        replace(GOOD, status="locally_infeasible"),
        replace(GOOD, status="complementarity_stalled"),
        replace(GOOD, residual=2e-8),
        replace(GOOD, residual=None),
        replace(GOOD, modes=""),
    ],
)
def test_a_success_is_solved_strict_and_touches(bad: Ended) -> None:
    assert succeeded(CASE, GOOD)
    assert not succeeded(CASE, bad)


def test_what_fails_its_certificate_is_an_optimum_but_no_success() -> None:
    one = replace(GOOD, status="certificate_failed")
    assert solved(CASE, one)
    assert not succeeded(CASE, one)
    text = row(CASE, [GOOD, one])
    assert text.split()[1:6] == ["1", "of", "2", "3/4", "2"]
    assert text.endswith("1 not certified")


def test_the_table_counts_successes_and_says_why_others_failed() -> None:
    other = replace(GOOD, objective=4.0, modes="| tip=sticking |")
    text = row(CASE, [GOOD, GOOD, other, replace(GOOD, modes="")])
    assert text.split()[:7] == ["finger", "3", "of", "4", "3/4", "3", "0.50"]
    assert "MISSED" not in text
    assert text.endswith("1 nothing touches")
    assert "MISSED" in row(CASE, [GOOD, replace(GOOD, modes="")])
    assert "MISSED" in row(CASE, [replace(GOOD, seconds=2.0)])


def test_noise_is_about_the_own_guess_and_seed_zero_has_none() -> None:
    poses = {"kind": "poses", "poses": [{"at": 0}, {"at": 1}]}
    document = {"name": "x", "guess": poses, "multistart": 5, "phases": [{"name": "p"}]}
    assert noisy(document, 0, 0.2) == {k: v for k, v in document.items() if k != "multistart"}
    found = noisy(document, 3, 0.2)
    assert found["guess"] == {"kind": "random", "seed": 3, "spread": 0.2, "about": poses}
    assert "multistart" not in found
    bare = noisy({"phases": [{"name": "p", "guess": poses}]}, 1, 0.2)
    assert bare["guess"] == {"kind": "random", "seed": 1, "spread": 0.2}
    assert bare["phases"][0]["guess"]["about"] == poses


def test_the_promises_are_those_of_the_issue() -> None:
    promised = {case.example: case.aim for case in CASES}
    assert promised["gripper"] == promised["spring_flamingo"] == (18, 20)
    assert promised["finger_no_gravity"] == (95, 100)
