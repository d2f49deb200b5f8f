"""Recursive Newton-Euler over trees against the judge's body Jacobians, and against formulas."""

from typing import Any

import numpy as np
import pytest

from schemas.expressions import derivative
from solver.simulation.spatial import SpatialMultibody
from tests.support.robots import LOOSE, PENDULUM, TREE, equations, evaluated, system

POINTS = 5
FEET = {"foot": {"link": "welded", "at": [0.1, 0, -0.2], "radius": 0.03}, "toe": {"link": "led"}}
PUSHES = {
    "thrust": {"link": "skew", "at": [0, 0.1, 0], "direction": [1, "s", 0], "value": "u^2"},
    "wind": {"link": "root", "direction": [0, 1, 0], "value": "root.vx + t", "frame": "world"},
}
CASES: list[tuple[str, str, dict[str, Any]]] = [
    (PENDULUM, "fixed", {}),
    (TREE, "fixed", {}),
    (TREE, "planar", {}),
    (TREE, "floating", {"gravity": [1, 2, -3]}),
    (LOOSE, "fixed", {}),
    (LOOSE, "floating", {"motors": []}),
    (TREE, "floating", {"contacts": FEET, "mode": {"foot": "sticking", "toe": "frictionless"}}),
    (TREE, "fixed", {"forces": PUSHES, "controls": ["u"], "parameters": {"s": 2}}),
]


@pytest.mark.parametrize(("text", "base", "more"), CASES)
def test_the_judge_finds_the_accelerations_that_solve_the_residuals(
    text: str, base: str, more: dict[str, Any]
) -> None:
    one = system(text, base=base, **more)
    found, tape = equations(one, [])
    model = SpatialMultibody.of(one)
    q, v, u = _states(one)
    held = model.accelerations(0.7, q, v, u)
    forces = np.array([held.forces[name] for name in found.forces]).reshape(-1, POINTS)
    rows = evaluated(tape, q, v, held.accelerations, u, forces, np.full((2, POINTS), [[0.7], [2]]))
    assert np.abs(rows).max() < 1e-10 * (1 + np.abs(model.forces(0.7, q, v, u)).max())


@pytest.mark.parametrize(("text", "base"), [(TREE, "floating"), (LOOSE, "fixed")])
def test_places_energies_and_momenta_agree(text: str, base: str) -> None:
    one = system(text, base=base)
    names = [
        name
        for name in one.defined
        if not name.endswith(("norm", "power", "speed")) and name != "follow"
    ]
    _, tape = equations(one, names)
    q, v, u = _states(one)
    rows = evaluated(tape, q, v, np.zeros_like(q), u, np.full((2, POINTS), [[0.0], [2]]))
    judged = SpatialMultibody.of(one).values(names, 0.0, q, v, u)
    assert rows[len(one.coordinates) :] == pytest.approx(judged, rel=1e-11, abs=1e-11)


def test_the_norm_of_a_quaternion_does_not_matter() -> None:
    one = system(TREE, base="floating")
    which = [one.coordinates.index(f"base.q{part}") for part in "wxyz"]
    q, v, u = _states(one)
    long, fast = q.copy(), v.copy()
    long[which], fast[which] = 3 * q[which], 3 * v[which] + 5 * q[which]
    names = ["skew.x", "skew.vx", "skew.wy", "energy.kinetic"]
    model = SpatialMultibody.of(one)
    assert model.values(names, 0.0, long, fast, u) == pytest.approx(
        model.values(names, 0.0, q, v, u), rel=1e-11
    )
    others = [row for row in range(len(q)) if row not in which]
    ours = model.accelerations(0.0, long, fast, u).accelerations[others]
    assert ours == pytest.approx(model.accelerations(0.0, q, v, u).accelerations[others], rel=1e-9)


def test_rates_of_places_are_what_differentiation_gives() -> None:
    """``LINK.d(x)`` is written, not derived: both are the same."""
    one = system(TREE, base="floating")
    names = [f"skew.{axis}" for axis in "xyz"] + ["com.x", "skew.wx", "energy.kinetic"]
    rates = [derivative(name) for name in names]
    seconds = [derivative(name, 2) for name in names[:3]]
    _, tape = equations(one, [*names, *rates, *seconds])
    q, v, u = _states(one)
    a, h = np.random.default_rng(4).normal(size=q.shape), 1e-4

    def at(t: float) -> Any:
        moved = q + t * v + t * t / 2 * a
        rows = evaluated(tape, moved, v + t * a, a, u, np.full((2, POINTS), [[0.0], [2]]))
        return rows[len(one.coordinates) :]

    slopes = (at(h) - at(-h)) / (2 * h)
    assert at(0)[6:12] == pytest.approx(slopes[:6], rel=1e-5, abs=1e-5)
    assert at(0)[12:] == pytest.approx(slopes[6:9], rel=1e-5, abs=1e-5)


def test_a_pendulum_by_its_formula() -> None:
    one = system(PENDULUM)
    q, v = np.array([[0.4]]), np.array([[1.1]])
    found = SpatialMultibody.of(one).accelerations(0.0, q, v, np.array([[0.3]]))
    expected = (0.3 - 2 * 9.81 * 0.5 * np.sin(0.4)) / (2 * 0.25)
    assert found.accelerations[0, 0] == pytest.approx(expected)


def test_a_spinning_body_keeps_energy_and_momentum() -> None:
    """Torque-free: the rates of energy and spin vanish with the judge's accelerations."""
    one = system(LOOSE, base="floating", motors=[], gravity=[0, 0, 0])
    model = SpatialMultibody.of(one)
    q, v, u = _states(one)
    a = model.accelerations(0.0, q, v, u).accelerations
    h = 1e-5
    names = ["energy.kinetic", "com.spin_x", "com.spin_y", "com.spin_z", "com.px"]

    def at(t: float) -> Any:
        return model.values(names, 0.0, q + t * v + t * t / 2 * a, v + t * a, u)

    assert np.abs(at(h) - at(-h)).max() / (2 * h) < 1e-6


def _states(one: Any) -> Any:
    rng = np.random.default_rng(3)
    n, m = len(one.coordinates), len(one.control_names)
    return rng.normal(size=(n, POINTS)), rng.normal(size=(n, POINTS)), rng.normal(size=(m, POINTS))


@pytest.mark.parametrize(
    ("mode", "dependent"),
    [
        ({"heel": "sticking", "toe": "sticking_y", "side": "frictionless"}, ()),
        ({"heel": "sticking", "toe": "sticking_x", "side": "sticking_y"}, ("contact.side.slip_y",)),
    ],
)
def test_contacts_that_hold_the_same_are_found(mode: dict[str, str], dependent: Any) -> None:
    """A rigid foot has six ways to move."""
    places = {"heel": [-0.1, 0, 0], "toe": [0.2, 0.05, 0], "side": [0.1, -0.1, 0]}
    contacts = {name: {"link": "swung", "at": at} for name, at in places.items()}
    one = system(TREE, base="floating", contacts=contacts, mode=mode)
    assert equations(one, [])[0].dependent == dependent


def test_across_the_plane_of_a_planar_base_nothing_holds() -> None:
    more = {"base": "planar", "contacts": {"foot": {"link": "bob"}}}
    assert equations(system(PENDULUM, mode={"foot": "sticking"}, **more), [])[0].dependent
    assert not equations(system(PENDULUM, mode={"foot": "sticking_x"}, **more), [])[0].dependent
