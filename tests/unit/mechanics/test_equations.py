"""Recursive Newton-Euler over trees against the judge's body Jacobians."""

import numpy as np
import pytest

from schemas.expressions import derivative
from schemas.mechanisms import Mechanism
from solver.simulation.multibody import Multibody
from tests.support.lowered import Lowered
from tests.support.machines import Build, cart_pole, chain, crane, double_pendulum, machine, rolling

SAME = 1e-11

LEG = {"mass": 0.7, "inertia": 0.03, "com": [0.02, -0.3]}


def walker(**more: object) -> Mechanism:
    """A floating trunk with a welded box, hinges and sliders in every order, all with offsets."""
    joint = {"kind": "revolute", "angle": 0.4, "to": [0.05, 0.1]}
    slide = {"kind": "prismatic", "axis": [1, -2], "angle": -0.3, "to": [0.03, 0.02]}
    return machine(
        {
            "parameters": {"m": 1.3, "L": 0.7},
            "bodies": {
                "trunk": {"mass": "2*m", "inertia": 0.3, "com": [0.1, "L/3"]},
                "box": {"mass": 0.5, "inertia": 0.02, "com": [0.05, -0.1]},
                **dict.fromkeys(("thigh", "shank", "sole", "toe", "mast"), LEG),
                "frame": {},
            },
            "joints": {
                "mast": {**slide, "parent": "frame", "child": "mast"},
                "free": {"kind": "floating", "child": "trunk"},
                "weld": {
                    "kind": "welded",
                    "parent": "trunk",
                    "child": "box",
                    "angle": 0.7,
                    "at": [0.2, 0.3],
                    "to": [-0.1, 0.05],
                },
                "hip": {**joint, "parent": "box", "child": "thigh", "at": [0.1, -0.2]},
                "knee": {"kind": "revolute", "parent": "thigh", "child": "shank", "at": [0, "-L"]},
                "leg": {**slide, "parent": "shank", "child": "sole", "at": [0, -0.6]},
                "ankle": {**joint, "parent": "sole", "child": "toe", "at": [0.1, 0.1]},
                "lift": {"kind": "prismatic", "parent": "trunk", "child": "frame", "axis": [0, 1]},
            },
            "motors": {"hip": {"joint": "hip", "gear": 3}, "leg": {"joint": "leg"}},
            "springs": {
                "knee": {"joint": "knee", "stiffness": 20, "rest": 0.2, "damping": 0.3},
                "calf": {
                    "between": [{"body": "thigh", "at": [0, -0.2]}, {"body": "toe"}],
                    "stiffness": 12,
                    "rest": 0.3,
                    "damping": 0.1,
                },
                "rope": {
                    "between": [{"body": "ground", "at": [1, 2]}, {"body": "mast"}],
                    "stiffness": 5,
                    "rest": 0.3,
                    "pulling_only": True,
                    "engaged": 0.5,
                },
            },
            **more,
        }
    )


BUILDERS = [double_pendulum, cart_pole, chain, crane, walker]


def applied(low: Lowered, at: dict[str, np.ndarray]) -> np.ndarray:
    """What the residuals are by the judge, contacts and loops aside, (N, n)."""
    judge = Multibody.of(low.mechanism)
    q, v, a = (low.stacked(at, order) for order in range(3))
    u = np.array([at[name] for name in judge.controls]).reshape(-1, q.shape[1])
    return np.einsum("Nij,jN->Ni", judge.mass(q), a) - judge.forces(at["t"], q, v, u)


def rows(low: Lowered, at: dict[str, np.ndarray]) -> np.ndarray:
    names = [f"#dynamics {name}" for name in low.mechanism.coordinates]
    return low(names, at).T


@pytest.mark.parametrize("angles", ["relative", "absolute"])
@pytest.mark.parametrize("build", BUILDERS)
def test_the_residuals_are_those_of_the_judge(build: Build, angles: str) -> None:
    low = Lowered(build(angles=angles))
    at = low.random()
    np.testing.assert_allclose(rows(low, at), applied(low, at), rtol=SAME, atol=SAME)


@pytest.mark.parametrize("angles", ["relative", "absolute"])
@pytest.mark.parametrize("height", [0, "0.3*x", "0.2*sin(x)"])
def test_contact_forces_push_as_the_judge_says(angles: str, height: object) -> None:
    modes = dict.fromkeys(("rolls", "toe", "heel", "bump", "poke"), "sticking")
    low = Lowered(rolling(height, angles=angles, mode=modes))
    at = low.random()
    q, v = low.stacked(at), low.stacked(at, 1)
    judged = Multibody.of(low.mechanism)
    found = judged.contacts(q, v)
    expected = applied(low, at)
    for pair, name in enumerate(judged.pairs):
        normal, tangential = (at[f"contact.{name}.{way}"] for way in ("normal", "tangential"))
        expected -= (found.Gn[pair] * normal + found.Jt[pair] * tangential).T
    np.testing.assert_allclose(rows(low, at), expected, rtol=SAME, atol=SAME)


def test_gaps_slips_and_their_accelerations_are_those_of_the_judge() -> None:
    modes = dict.fromkeys(("rolls", "toe", "heel", "bump", "poke"), "sticking")
    low = Lowered(rolling("0.2*sin(x)", mode=modes))
    at = low.random()
    q, v, a = (low.stacked(at, order) for order in range(3))
    judged = Multibody.of(low.mechanism)
    found = judged.contacts(q, v)
    for pair, name in enumerate(judged.pairs):
        own = f"contact.{name}"
        names = [f"{own}.gap", f"{own}.d(gap)", f"{own}.slip", f"{own}.dd(gap)", f"{own}.d(slip)"]
        expected = [
            found.gaps[pair],
            found.gap_rates[pair],
            found.slips[pair],
            np.einsum("jN,jN->N", found.Jn[pair], a) + found.gap_bias[pair],
            np.einsum("jN,jN->N", found.Jt[pair], a) + found.slip_bias[pair],
        ]
        np.testing.assert_allclose(low(names, at), expected, rtol=1e-9, atol=1e-10, err_msg=name)


def test_a_loop_holds_its_places_together() -> None:
    pin = {"between": [{"body": "toe", "at": [0.1, 0]}, {"body": "ground", "at": [1, 1]}]}
    low = Lowered(walker(loops={"pin": pin}))
    at = low.random()
    judged = Multibody.of(low.mechanism)
    q, v, a = (low.stacked(at, order) for order in range(3))
    found = judged.loops(q, v)
    force = at["loop.pin.x"] + 1j * at["loop.pin.y"]
    pushed = (found.slopes[0].conj() * force).real.T
    np.testing.assert_allclose(rows(low, at), applied(low, at) - pushed, rtol=SAME, atol=SAME)
    opening = np.einsum("jN,jN->N", found.slopes[0], a) + found.bias[0]
    held = low(["#held acceleration loop.pin.x", "#held acceleration loop.pin.y"], at)
    np.testing.assert_allclose(held, [opening.real, opening.imag], rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize(
    ("mode", "factor"), [("sliding_right", -0.6), ("sliding_left", 0.6), ("frictionless", 0.0)]
)
def test_sliding_contacts_rub_against_the_slip(mode: str, factor: float) -> None:
    low = Lowered(rolling(mode={"toe": mode}))
    at = low.random()
    assert low.equations.forces == ("contact.toe.normal",)
    (tangential,) = low(["contact.toe.tangential"], at)
    np.testing.assert_allclose(tangential, factor * at["contact.toe.normal"])


def test_open_contacts_have_no_force() -> None:
    low = Lowered(rolling())
    assert not low.equations.forces
    assert not low(["contact.toe.normal", "contact.toe.tangential"], low.random()).any()


def test_both_kinds_of_angles_move_alike() -> None:
    relative, absolute = Lowered(walker(angles="relative")), Lowered(walker(angles="absolute"))
    at = relative.random()
    same = absolute.mechanism.coordinates
    for order in range(3):
        names = [derivative(name, order) for name in same]
        at |= dict(zip(names, relative(names, at), strict=True))
    names = ["toe.x", "toe.vy", "com.spin", "energy.total", "hip", "d(ankle)", "spring.calf.force"]
    np.testing.assert_allclose(absolute(names, at), relative(names, at), rtol=1e-12, atol=1e-12)
