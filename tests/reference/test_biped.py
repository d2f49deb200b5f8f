"""The five-link biped of 003, section 7.9, in both of its forms."""

from typing import Any

import numpy as np
import pytest

import examples
from schemas.expressions import derivative
from schemas.mechanisms import Mechanism
from schemas.reading import read_problem
from schemas.results import Solution
from solver import solve
from solver.simulation.multibody import Multibody

FORMS = ("five_link_biped", "five_link_biped_floating")


def solved(name: str, **changes: Any) -> Solution:
    return solve(read_problem(examples.load(name) | changes))


@pytest.mark.parametrize(
    ("name", "objective"), [(FORMS[0], 390.7904), ("five_link_biped_high_torso", 469.5011)]
)
def test_on_the_papers_mesh(name: str, objective: float) -> None:
    """25 Hermite-Simpson segments, from the paper's guess."""
    solution = solved(name, refinement=None)
    assert solution.objective == pytest.approx(objective, abs=1e-4)
    assert solution.solver.iterations <= 15


def test_both_forms_agree() -> None:
    """A hinge at the foot with a collision map, and a floating base whose foot sticks."""
    hinge, floating = (solved(name) for name in FORMS)
    assert floating.objective == pytest.approx(hinge.objective, rel=1e-7)
    step, left = "step.impact.swing_foot", "step/left.impact.right_foot"
    for way in ("normal", "tangential"):
        one, two = hinge.static[f"{step}.{way}"], floating.static[f"{left}.{way}"]
        assert one == pytest.approx(two, rel=1e-4)


@pytest.mark.parametrize("name", [FORMS[1], "rabbit_running"])
def test_the_stance_foot_stays_where_it_stands(name: str) -> None:
    """At every node, by the kinematics of the judge."""
    solution = solved(name, refinement=None)
    system = read_problem(examples.load(name)).phases[0].system
    assert isinstance(system, Mechanism)
    judge, nodes = Multibody.of(system), solution.phases[0].groups["states"].values
    q, v = (
        np.array([nodes[series] for series in names], dtype=float)
        for names in (judge.coordinates, map(derivative, judge.coordinates))
    )
    foot, contacts = judge.pairs.index("left_foot"), judge.contacts(q, v)
    assert np.abs(contacts.gaps[foot]).max() < 1e-10
    assert np.abs(contacts.gap_rates[foot]).max() < 1e-10
    assert np.abs(contacts.slips[foot]).max() < 1e-10
    place = judge.values(["left_foot.x"], np.zeros(q.shape[1]), q, v, np.zeros((4, q.shape[1])))
    assert np.ptp(place) < 1e-10
