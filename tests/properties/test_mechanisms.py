"""Random mechanisms: the lowered equations of motion are those of the judge, whatever the tree."""

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.mechanisms import Mechanism
from solver.simulation.multibody import Multibody
from tests.support.lowered import Lowered
from tests.support.machines import machine

numbers = st.integers(-8, 8).map(lambda n: n / 10)
vectors = st.tuples(numbers, numbers).map(list)
axes = st.sampled_from([[1, 0], [0, 1], [-1, 2], [3, 0.5]])
kinds = st.sampled_from(["revolute", "revolute", "prismatic", "welded", "floating"])


@st.composite
def mechanisms(draw: Any) -> Mechanism:
    """A tree of some bodies, hung on each other in any way; some of them mere frames."""
    bodies: dict[str, Any] = {}
    joints: dict[str, Any] = {}
    for number in range(draw(st.integers(1, 6))):
        parents = ["ground", *bodies]
        name, parent = f"body{number}", draw(st.sampled_from(parents))
        kind = draw(kinds) if number else draw(st.sampled_from(["revolute", "prismatic"]))
        bodies[name] = {"mass": 1.5, "inertia": 0.3, "com": draw(vectors)}
        if draw(st.integers(0, 4)) == 0 and number == 0:
            bodies[name] = {}
        joint: dict[str, Any] = {"kind": kind, "child": name}
        if kind != "floating":
            joint |= {"parent": parent, "at": draw(vectors), "to": draw(vectors)}
            joint |= {"angle": draw(numbers)}
        if kind == "prismatic":
            joint["axis"] = draw(axes)
        joints[f"joint{number}"] = joint
    moving = [n for n, one in joints.items() if one["kind"] in ("revolute", "prismatic")]
    places = [{"body": list(bodies)[-1], "at": draw(vectors)}, {"body": "ground", "at": [9, 9]}]
    springs = {
        "coil": {"joint": moving[-1], "stiffness": 3, "rest": 0.1, "damping": 0.2},
        "rope": {"between": places, "stiffness": 2, "rest": 0.4, "damping": 0.1},
    }
    forces = {
        "wind": {
            "body": list(bodies)[-1],
            "at": draw(vectors),
            "direction": draw(axes),
            "frame": draw(st.sampled_from(["body", "world"])),
            "value": "0.3*t",
        }
    }
    return machine(
        {
            "angles": draw(st.sampled_from(["relative", "absolute"])),
            "gravity": draw(vectors),
            "bodies": bodies,
            "joints": joints,
            "motors": {"drive": {"joint": moving[0], "gear": 2}},
            "springs": springs,
            "forces": forces,
        }
    )


@settings(max_examples=60, deadline=None)
@given(mechanisms())
def test_the_equations_of_motion_are_the_judges(mechanism: Mechanism) -> None:
    low = Lowered(mechanism)
    judge = Multibody.of(mechanism)
    at = low.random(3)
    q, v, a = (low.stacked(at, order) for order in range(3))
    u = np.array([at[name] for name in judge.controls])
    expected = np.einsum("Nij,jN->Ni", judge.mass(q), a) - judge.forces(at["t"], q, v, u)
    found = low([f"#dynamics {name}" for name in mechanism.coordinates], at).T
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)
