"""Impacts are written by one hand and judged by another: both read the same mechanisms alike."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import examples
from schemas import resolve
from schemas.expressions import Tree, derivative, names_in
from schemas.mechanisms import Mechanism
from schemas.reading import read_problem
from solver import solve
from solver.lowering.derivations import Derivations
from solver.mechanics.impact import Shock, freed
from solver.numeric.tape import Scope, record
from solver.simulation.multibody import Multibody
from tests.unit.hybrid.documents import wheel

GAITS = ("five_link_biped_floating", "rabbit_running", "hopper_hybrid")
PLACES = 5


def mechanism_of(document: dict[str, Any]) -> Mechanism:
    system = read_problem(document).phases[0].system
    assert isinstance(system, Mechanism)
    return system


def values(shock: Shock, trees: list[Tree], q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Trees over places in numbers, (trees, places)."""
    mechanism = shock.mechanism
    constants = resolve.parameters(mechanism)
    known = {*mechanism.coordinates, "t"}
    given = shock.frames.trees
    for name in mechanism.contacts:
        place = shock.frames.place(mechanism.contacts[name])
        given = given | dict(zip((f"{name}.x", f"{name}.y"), place, strict=True))
    derivations = Derivations(given, constants, (), known.__contains__)
    names = [name.name for tree in trees for name in names_in(tree)]
    derivations.demand(names)
    scope = Scope(mechanism.coordinates, constants, derivations.definitions(names))
    return record(trees, scope)(list(q), q.shape[1:])


@pytest.mark.parametrize(
    "document",
    [*map(examples.load, GAITS), wheel("0"), wheel("0.1*sin(3*x)")],
    ids=[*GAITS, "wheel", "wheel_on_hills"],
)
def test_mass_and_directions(document: dict[str, Any]) -> None:
    mechanism = mechanism_of(document)
    shock, judge = Shock.of(mechanism), Multibody.of(mechanism)
    names = mechanism.coordinates
    q = np.random.default_rng(3).uniform(-1, 1, (len(names), PLACES))
    M = values(shock, [shock.inertia(a, b) for a in names for b in names], q)
    theirs = judge.mass(q).reshape(PLACES, -1).T
    assert np.allclose(M, theirs, atol=1e-12)
    contacts = judge.contacts(q, np.zeros_like(q))
    for index, pair in enumerate(judge.pairs):
        for side, rows in ((0, contacts.Gn), (1, contacts.Jt)):
            ours = values(shock, [shock.push(pair, name, side) for name in names], q)
            assert np.allclose(ours, rows[index], atol=1e-12)


def test_a_freed_pin() -> None:
    mechanism = freed(mechanism_of(examples.load("five_link_biped")), "ankle")
    shock, judge = Shock.of(mechanism), Multibody.of(mechanism)
    names = mechanism.coordinates
    q = np.random.default_rng(3).uniform(-1, 1, (len(names), PLACES))
    M = values(shock, [shock.inertia(a, b) for a in names for b in names], q)
    assert np.allclose(M, judge.mass(q).reshape(PLACES, -1).T, atol=1e-12)


def test_a_found_impact_is_one() -> None:
    """M (v+ - v-) = J' L at the end of a running stride, from the result and the judge alone."""
    document = examples.load("rabbit_running") | {"refinement": None}
    result = solve(read_problem(document))
    judge = Multibody.of(mechanism_of(document))
    swap = read_problem(document).phases[0].periodic
    assert swap is not None
    first, last = (phase.groups["states"].values for phase in (result.phases[0], result.phases[-1]))
    names = judge.coordinates
    q = np.array([last[name][-1] for name in names], dtype=float)
    before, after = (
        np.array([one[key][at] for key in keys], dtype=float)
        for one, at, keys in (
            (last, -1, [derivative(name) for name in names]),
            (first, 0, [derivative(swap.swapped(name)) for name in names]),
        )
    )
    contacts = judge.contacts(q[:, None], before[:, None])
    foot = judge.pairs.index("right_foot")
    ways = ("normal", "tangential")
    static = [result.static[f"stride/flight.impact.right_foot.{way}"] for way in ways]
    impulse = np.array(static, dtype=float)
    push = contacts.Gn[foot, :, 0] * impulse[0] + contacts.Jt[foot, :, 0] * impulse[1]
    assert np.allclose(judge.mass(q) @ (after - before), push, atol=1e-6)
    assert np.allclose(contacts.Jt[foot, :, 0] @ after, 0, atol=1e-9)
    assert np.allclose(contacts.Jn[foot, :, 0] @ after, 0, atol=1e-9)
