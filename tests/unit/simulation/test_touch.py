"""Contacts: gaps, slips and their accelerations; forces of what is held."""

import numpy as np
import pytest

from solver.simulation.multibody import Multibody
from tests.support.machines import double_pendulum, machine, rolling

STEP = 1e-6
HEIGHT = "0.2*sin(x) + 0.05*x^2"


def random(model: Multibody, points: int = 4) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(11)
    n = len(model.coordinates)
    return generator.normal(size=(n, points)), generator.normal(size=(n, points))


@pytest.mark.parametrize("height", [0.3, HEIGHT])
def test_gaps_slips_and_their_rates_against_differences(height: object) -> None:
    model = Multibody.of(rolling(height))
    q, v = random(model)
    now, ahead, behind = (model.contacts(q + shift * v, v) for shift in (0, STEP, -STEP))
    rate = (ahead.gaps - behind.gaps) / (2 * STEP)
    np.testing.assert_allclose(now.gap_rates, rate, atol=1e-8)
    np.testing.assert_allclose(np.einsum("pnN,nN->pN", now.Jn, v), now.gap_rates, atol=1e-13)
    np.testing.assert_allclose(np.einsum("pnN,nN->pN", now.Jt, v), now.slips, atol=1e-13)
    bias = (ahead.gap_rates - behind.gap_rates) / (2 * STEP)
    np.testing.assert_allclose(now.gap_bias, bias, atol=1e-7)
    slid = (ahead.slips - behind.slips) / (2 * STEP)
    np.testing.assert_allclose(now.slip_bias, slid, atol=1e-7)


def test_a_wheel_that_rolls_does_not_slip() -> None:
    model = Multibody.of(rolling())
    q = np.zeros(len(model.coordinates))
    v = np.zeros_like(q)
    q[1] = 0.3 - 0.02  # the rim's centre is 0.02 above the wheel's origin
    v[0], v[2] = 0.3 * -2 + 0.02 * -2, -2.0
    contacts = model.contacts(q, v)
    pair = model.pairs.index("rolls")
    assert contacts.gaps[pair, 0] == pytest.approx(0, abs=1e-15)
    # the material at the contact, right below the rim's centre, moves with the body
    slip = v[0] - v[2] * (0.02 - 0.3)
    assert contacts.slips[pair, 0] == pytest.approx(slip)
    assert contacts.normals[pair, 0] == pytest.approx(1j)


def test_a_circle_is_as_far_from_a_circle_as_their_centres_less_both_radii() -> None:
    model = Multibody.of(rolling())
    q, v = random(model)
    wheel = model.at(0.0, q, v)
    rim, edge = wheel.parts.touch.places[0][3], wheel.parts.touch.places[1][3]
    apart = np.abs(wheel.pose.points(np.array([rim])).z[0] - (edge @ wheel.pose.features))
    np.testing.assert_allclose(wheel.contacts.gaps[3], apart - 0.3 - 0.4, atol=1e-14)


def test_an_ellipse_touches_where_its_equation_says() -> None:
    model = Multibody.of(
        machine(
            {
                "bodies": {"egg": {"mass": 1, "inertia": 1}, "fly": {"mass": 1, "inertia": 1}},
                "joints": {
                    "one": {"kind": "floating", "child": "egg"},
                    "two": {"kind": "floating", "child": "fly"},
                },
                "contacts": {"foot": {"body": "fly"}},
                "surfaces": {},
                "shapes": {"shell": {"body": "egg", "ellipse": [0.5, 0.3]}},
                "pairs": {"foot": {"contact": "foot", "against": "shell"}},
            }
        )
    )
    angle, turn = np.linspace(0, 6, 13), 0.7
    place = (0.5 * np.cos(angle) + 0.3j * np.sin(angle)) * np.exp(1j * turn)
    q = np.array([np.full(13, 1.0), np.full(13, 2.0), np.full(13, turn), *np.zeros((3, 13))])
    q[3], q[4] = 1 + place.real, 2 + place.imag
    contacts = model.contacts(q, np.zeros_like(q))
    np.testing.assert_allclose(contacts.gaps[0], 0, atol=1e-15)
    outward = (np.cos(angle) / 0.5 + 1j * np.sin(angle) / 0.3) * np.exp(1j * turn)
    np.testing.assert_allclose(contacts.normals[0], outward / np.abs(outward), atol=1e-14)
    near = q.copy()
    near[3] += 1e-4 * contacts.normals[0].real
    near[4] += 1e-4 * contacts.normals[0].imag
    found = model.contacts(near, np.zeros_like(q)).gaps[0]
    np.testing.assert_allclose(found, 1e-4, rtol=1e-3)


def test_friction_and_restitution_are_the_pairs_own_or_the_surfaces() -> None:
    model = Multibody.of(rolling())
    assert model.pairs == ("rolls", "toe", "heel", "bump", "poke")
    assert model.friction.tolist() == [0.6, 0.6, 0.6, 0.2, 1.0]
    assert not model.restitution.any()


@pytest.mark.parametrize("height", [0.0, HEIGHT])
def test_what_is_held_has_no_acceleration(height: object) -> None:
    model = Multibody.of(rolling(height))
    q, v = random(model)
    mode = {"toe": "sticking", "rolls": "sliding_right", "bump": "frictionless"}
    held = model.accelerations(0.0, q, v, np.zeros((0, 4)), mode)
    contacts = model.contacts(q, v)
    for name in mode:
        row = model.pairs.index(name)
        gap = np.einsum("nN,nN->N", contacts.Jn[row], held.accelerations)
        np.testing.assert_allclose(gap, -contacts.gap_bias[row], atol=1e-9)
    toe = model.pairs.index("toe")
    slip = np.einsum("nN,nN->N", contacts.Jt[toe], held.accelerations)
    np.testing.assert_allclose(slip, -contacts.slip_bias[toe], atol=1e-9)
    forces = held.forces
    np.testing.assert_allclose(
        forces["contact.rolls.tangential"], -0.6 * forces["contact.rolls.normal"]
    )
    assert not np.any(forces["contact.bump.tangential"])


def test_a_block_on_the_ground_slides_by_coulomb() -> None:
    model = Multibody.of(rolling())
    q, v = np.zeros(7), np.zeros(7)
    v[3] = 1.0  # the stick lies on both of its points and slides to the right
    mode = {"toe": "sliding", "heel": "sliding"}
    held = model.accelerations(0.0, q, v, np.zeros(0), mode)
    assert held.accelerations[3] == pytest.approx(-0.6 * 9.81)
    total = held.forces["contact.toe.normal"] + held.forces["contact.heel.normal"]
    assert total == pytest.approx(9.81)
    # friction passes below the middle only if the legs are long: here both carry the same
    assert held.forces["contact.toe.normal"] == pytest.approx(held.forces["contact.heel.normal"])


def test_redundant_friction_is_shared_and_changes_nothing() -> None:
    model = Multibody.of(rolling())
    q = np.zeros(7)
    both = model.accelerations(0.0, q, q, np.zeros(0), {"toe": "sticking", "heel": "sticking"})
    assert both.accelerations[3:6] == pytest.approx([0, 0, 0], abs=1e-12)
    assert both.forces["contact.toe.normal"] == pytest.approx(9.81 / 2)
    assert both.forces["contact.toe.tangential"] == pytest.approx(0, abs=1e-12)
    given = {"contact.heel.tangential": np.array(0.7)}
    known = model.accelerations(
        0.0, q, q, np.zeros(0), {"toe": "sticking", "heel": "sticking"}, given
    )
    assert known.accelerations[3:6] == pytest.approx([0, 0, 0], abs=1e-12)
    assert known.forces["contact.toe.tangential"] == pytest.approx(-0.7)
    assert known.forces["contact.heel.tangential"] == pytest.approx(0.7)


def test_a_loose_force_is_a_control() -> None:
    mode = {"toe": "sticking", "heel": "sticking"}
    model = Multibody.of(rolling(mode=mode, loose=["contact.heel.tangential"]))
    assert model.controls == ("contact.heel.tangential",)
    held = model.accelerations(0.0, np.zeros(7), np.zeros(7), np.array([0.7]))
    assert held.accelerations[3:6] == pytest.approx([0, 0, 0], abs=1e-12)
    assert held.forces["contact.toe.tangential"] == pytest.approx(-0.7)


def test_a_loop_carries_what_the_joint_would() -> None:
    """A pendulum whose hinge is a loop, against one whose hinge is a joint."""
    free = machine(
        {
            "bodies": {"rod": {"mass": 2, "inertia": 0.3, "com": [0, -0.5]}},
            "joints": {"free": {"kind": "floating", "child": "rod"}},
            "loops": {"pin": {"between": [{"body": "ground", "at": [1, 2]}, {"body": "rod"}]}},
        }
    )
    model = Multibody.of(free)
    q, v = np.array([1, 2, 0.8]), np.array([0, 0, 1.5])
    held = model.accelerations(0.0, q, v, np.zeros(0))
    turning = -2 * 9.81 * 0.5 * np.sin(0.8) / (0.3 + 2 * 0.25)
    assert held.accelerations == pytest.approx([0, 0, turning], abs=1e-12)
    # the pin carries the rod: m (a - g) of its centre
    out, along = np.exp(1j * 0.8), np.exp(1j * (0.8 - np.pi / 2))
    push = 2 * (turning * 0.5 * out - 1.5**2 * 0.5 * along + 9.81j)
    assert held.forces["loop.pin.x"] == pytest.approx(push.real)
    assert held.forces["loop.pin.y"] == pytest.approx(push.imag)
    assert model.loops(q, v).z[0, 0] == pytest.approx(0)


def test_without_contacts_there_is_nothing_to_hold() -> None:
    model = Multibody.of(double_pendulum())
    assert model.pairs == ()
    assert model.accelerations(0.0, np.zeros(2), np.zeros(2), np.zeros(0)).forces == {}
