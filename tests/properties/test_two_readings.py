"""Any tree of bodies: the solver's recursion and the judge's Jacobians are one mechanics."""

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.mechanisms import Mechanism
from schemas.reading import read_problem
from solver.certificate.bodies import Bodies
from solver.lowering import lower
from solver.numeric import dynamics

numbers = st.floats(-1, 1).map(lambda value: round(value, 3))
vectors = st.lists(numbers, min_size=2, max_size=2)
sizes = st.floats(0.1, 2).map(lambda value: round(value, 3))


@st.composite
def joints(draw: st.DrawFn, row: int) -> dict[str, Any]:
    """The joint that carries a body on an earlier one, or on the ground."""
    kind = draw(st.sampled_from(["revolute", "prismatic", "revolute", "welded", "floating"]))
    if kind == "floating":
        return {"kind": kind, "child": f"b{row}"}
    parent = draw(st.integers(-1, row - 1))
    joint: dict[str, Any] = {
        "kind": kind,
        "parent": "ground" if parent < 0 else f"b{parent}",
        "child": f"b{row}",
        "at": draw(vectors),
        "to": draw(vectors),
        "angle": draw(numbers),
    }
    if kind == "prismatic":
        joint["axis"] = draw(vectors.filter(lambda axis: abs(axis[0]) + abs(axis[1]) > 0.1))
    return joint


@st.composite
def machines(draw: st.DrawFn) -> dict[str, Any]:
    """One to six bodies with springs and motors between them."""
    count = draw(st.integers(1, 6))
    trees = {f"j{row}": draw(joints(row)) for row in range(count)}
    if all(joint["kind"] == "welded" for joint in trees.values()):
        trees["j0"] = {**trees["j0"], "kind": "revolute"}
    hinges = [name for name, one in trees.items() if one["kind"] in ("revolute", "prismatic")]
    last = f"b{count - 1}"
    return {
        "kind": "mechanism",
        "angles": draw(st.sampled_from(["relative", "absolute"])),
        "gravity": draw(vectors),
        "bodies": {
            f"b{row}": {"mass": draw(sizes), "inertia": draw(sizes), "com": draw(vectors)}
            for row in range(count)
        },
        "joints": trees,
        "motors": {name: {"joint": name, "gear": draw(sizes)} for name in hinges},
        "springs": {
            "across": {
                "between": [{"body": "ground", "at": [5, 5]}, {"body": last, "at": draw(vectors)}],
                "stiffness": draw(sizes),
                "damping": draw(sizes),
                "rest": draw(sizes),
            }
        },
    }


@given(machines(), st.integers(0, 1000))
@settings(max_examples=40, deadline=None)
def test_the_rates_are_the_same(document: dict[str, Any], seed: int) -> None:
    problem = read_problem({"phases": [{"system": document, "time": {"final": 1}}]})
    system, form = problem.phases[0].system, lower(problem)[0]
    assert isinstance(system, Mechanism)
    bodies = Bodies.of(form, system, {})
    assert bodies is not None
    generator = np.random.default_rng(seed)
    x, u = (generator.normal(size=(len(some), 3)) for some in (form.states, form.controls))
    t = np.zeros(3)
    assert np.all(np.linalg.eigvalsh(bodies.model.mass(x[: len(system.coordinates)])) > 0)
    np.testing.assert_allclose(dynamics(form)(t, x, u), bodies(t, x, u), rtol=1e-6, atol=1e-6)
