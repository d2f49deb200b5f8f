"""The jump of velocities at an impact, against its own formula in numbers."""

import numpy as np
import pytest

from schemas.expressions import Name, Number, Tree, constant
from schemas.mechanisms import Mechanism
from solver.mechanics.impact import PIN, Shock, freed, pin_of

ROD = {
    "kind": "mechanism",
    "bodies": {"rod": {"mass": 2.0, "inertia": 0.3, "com": [0.2, 0.5]}},
    "joints": {"base": {"kind": "floating", "child": "rod"}},
    "contacts": {"tip": {"body": "rod", "at": [0.1, -0.4]}},
}
LEGS = {
    "kind": "mechanism",
    "angles": "absolute",
    "bodies": {
        "shin": {"mass": 2.0, "inertia": 0.1, "com": [0, 0.3]},
        "thigh": {"mass": 5.0, "inertia": 0.2, "com": [0, 0.1]},
    },
    "joints": {
        "ankle": {"kind": "revolute", "child": "shin", "to": [0, -0.1]},
        "knee": {"kind": "revolute", "parent": "shin", "child": "thigh", "at": [0, 0.5]},
    },
    "contacts": {
        "heel": {"body": "shin", "at": [0, -0.1]},
        "toe": {"body": "thigh", "at": [0, 0.6]},
    },
}


def numbers(shock: Shock, pose: dict[str, float]) -> dict[str, float]:
    """The definitions that the trees of an impact use."""
    known = dict(pose)
    for body in shock.frames.carried:
        if body in shock.mechanism.bodies and f"{body}#cos" in shock.frames.trees:
            angle = known[f"{body}.angle"]
            known |= {f"{body}#cos": np.cos(angle), f"{body}#sin": np.sin(angle)}
    return known


def value(tree: Tree, known: dict[str, float]) -> float:
    return constant(tree, known)


def test_a_rod_strikes_with_its_tip() -> None:
    """M and J written down by hand."""
    shock = Shock.of(Mechanism.model_validate(ROD))
    angle = 0.7
    pose = numbers(shock, {"rod.x": 0.3, "rod.y": 0.9, "rod.angle": angle})
    c, s = np.cos(angle), np.sin(angle)
    com = np.array([-s * 0.2 - c * 0.5, c * 0.2 - s * 0.5])
    tip = np.array([-s * 0.1 + c * 0.4, c * 0.1 + s * 0.4])
    M = 2.0 * np.array([[1, 0, com[0]], [0, 1, com[1]], [com[0], com[1], com @ com + 0.15]])
    names = shock.mechanism.coordinates
    found = [[value(shock.inertia(a, b), pose) for b in names] for a in names]
    assert np.allclose(found, M, atol=1e-14)
    normal = [value(shock.push("tip", name, 0), pose) for name in names]
    along = [value(shock.push("tip", name, 1), pose) for name in names]
    assert np.allclose(normal, [0, 1, tip[1]])
    assert np.allclose(along, [1, 0, tip[0]])


def test_the_jump_is_what_the_impulse_makes() -> None:
    shock = Shock.of(Mechanism.model_validate(ROD))
    pose = numbers(shock, {"rod.x": 0.0, "rod.y": 0.4, "rod.angle": -0.2})
    names = shock.mechanism.coordinates
    M = np.array([[value(shock.inertia(a, b), pose) for b in names] for a in names])
    J = np.array(
        [[value(shock.push("tip", name, side), pose) for name in names] for side in (0, 1)]
    )
    change = dict(zip(names, np.linalg.solve(M, J.T @ [3.0, -0.4]), strict=True))
    rates: dict[str, Tree] = {name: Number(float(one)) for name, one in change.items()}
    for name in names:
        row = shock.jump(name, rates, {"tip": (Number(3.0), Number(-0.4))})
        assert value(row, pose) == pytest.approx(0, abs=1e-12)


def test_a_pin_is_found_and_freed() -> None:
    mechanism = Mechanism.model_validate(LEGS)
    assert pin_of(mechanism, "heel") == "ankle"
    assert pin_of(mechanism, "toe") is None
    free = freed(mechanism, "ankle")
    assert free.coordinates == [*PIN, "shin.angle", "thigh.angle"]
    assert mechanism.coordinates == ["shin.angle", "thigh.angle"]


def test_a_freed_mechanism_moves_as_a_whole() -> None:
    """Pushed at its pin, it has all its mass."""
    shock = Shock.of(freed(Mechanism.model_validate(LEGS), "ankle"))
    pose = numbers(shock, {"shin.angle": 0.4, "thigh.angle": -0.9})
    for name in PIN:
        assert value(shock.inertia(name, name), pose) == pytest.approx(7.0)
    assert value(shock.inertia(*PIN), pose) == 0
    lever = [value(shock.push("toe", "thigh.angle", side), pose) for side in (0, 1)]
    assert lever == pytest.approx([0.6 * np.sin(0.9), -0.6 * np.cos(0.9)])


def test_what_does_not_move_is_not_pushed() -> None:
    shock = Shock.of(Mechanism.model_validate(LEGS))
    assert shock.push("heel", "shin.angle", 0) == Number(0.0)
    assert shock.partial(Name("gravity"), "shin.angle") == Number(0.0)
