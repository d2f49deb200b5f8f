"""Slips over a step, against rolling that is known: no audit of work finds a wrong tangent."""

from typing import Any

import numpy as np
import pytest

from schemas.mechanisms import Mechanism
from solver.certificate.slipping import slipped
from solver.simulation.instant import Instant
from solver.simulation.multibody import Multibody
from tests.support.stepped import Array

KNOTS = np.linspace(0.0, 2.1, 8)
WHEEL: dict[str, Any] = {
    "kind": "mechanism",
    "bodies": {"wheel": {"mass": 1, "inertia": 1}, "drum": {"mass": 1, "inertia": 1}},
    "joints": {
        "free": {"kind": "floating", "child": "wheel"},
        "axle": {"kind": "revolute", "child": "drum"},
    },
    "contacts": {"rim": {"body": "wheel", "radius": 0.2}, "spot": {"body": "wheel"}},
}


def at(q: Array, **changes: Any) -> Instant:
    model = Multibody.of(Mechanism.model_validate({**WHEEL, **changes}))
    return model.at(KNOTS, q)


def over(contact: str, shape: dict[str, Any]) -> dict[str, Any]:
    return {
        "shapes": {"it": {"body": "drum", **shape}},
        "pairs": {"pair": {"contact": contact, "against": "it"}},
    }


def test_a_wheel_on_level_ground_rolls_or_slides() -> None:
    turn = np.sin(KNOTS)
    for share in (1.0, 0.4):
        q = np.array([-0.2 * share * turn, 0 * turn + 0.2, turn, 0 * turn])
        only = {"contacts": {"rim": WHEEL["contacts"]["rim"]}}
        found = slipped(at(q, **only), [False])
        assert found == pytest.approx(0.2 * (1 - share) * np.diff(turn)[None], abs=1e-15)


def test_a_wheel_rolls_about_a_drum_that_turns_too() -> None:
    """At each step 0.4 rad and more: arcs, not chords."""
    drum, around = 0.3 * KNOTS, 1.5 + 1.2 * KNOTS
    rolled = drum + (around - drum) * (0.5 + 0.2) / 0.2
    q = np.array([0.7 * np.cos(around), 0.7 * np.sin(around), rolled, drum])
    found = slipped(at(q, **over("rim", {"circle": 0.5})), [True])
    assert found == pytest.approx(0.0, abs=1e-14)
    q[2] += 0.1 * KNOTS
    assert slipped(at(q, **over("rim", {"circle": 0.5})), [True]) == pytest.approx(
        0.2 * 0.1 * np.diff(KNOTS)[None]
    )


@pytest.mark.parametrize("shape", [{"circle": 0.5}, {"ellipse": [0.6, 0.3]}])
def test_what_is_carried_along_does_not_slip(shape: dict[str, Any]) -> None:
    """A point on the outline of a body that turns by 0.36 rad a step."""
    a, b = shape.get("ellipse", [0.5, 0.5])
    drum = 1.2 * KNOTS
    place = (a * np.cos(0.7) + 1j * b * np.sin(0.7)) * np.exp(1j * drum)
    q = np.array([place.real, place.imag, 0 * drum, drum])
    pinned = slipped(at(q, **over("spot", shape)), ["circle" in shape])
    assert pinned == pytest.approx(0.0, abs=1e-14)


def test_a_point_slides_along_an_ellipse_by_its_arcs() -> None:
    """But for what a chord along the mean tangent lacks: second order in the step."""
    lacks = []
    for pace in (0.4, 0.2, 0.1):
        arc = 0.7 + pace * KNOTS
        place = 0.6 * np.cos(arc) + 0.3j * np.sin(arc)
        q = np.array([place.real, place.imag, 0 * arc, 0 * arc])
        fine = np.linspace(arc[:-1], arc[1:], 2001)
        line = 0.6 * np.cos(fine) + 0.3j * np.sin(fine)
        way = np.sum(np.abs(np.diff(line, axis=0)), axis=0)
        found = slipped(at(q, **over("spot", {"ellipse": [0.6, 0.3]})), [False])[0]
        assert np.all(found < 0)
        lacks.append(float(np.max(np.abs(1 + found / way))))
    assert lacks[0] < 5e-3
    assert lacks[0] / lacks[1] == pytest.approx(4, rel=0.2)
    assert lacks[1] / lacks[2] == pytest.approx(4, rel=0.2)
