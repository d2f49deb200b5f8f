"""What slips over a step is the material: no audit of work would see a wrong tangent."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from schemas.mechanisms import Mechanism
from tests.support.machines import machine
from tests.support.steps import Instance, Steps, turn

RADIUS, OTHER = 0.3, 0.5


def wheel(height: Any = 0, **more: Any) -> Mechanism:
    """A wheel on the ground, its contact's circle about its middle."""
    return machine(
        {
            "bodies": {"wheel": {"mass": 1, "inertia": 0.02}},
            "joints": {"one": {"kind": "floating", "child": "wheel"}},
            "contacts": {"rim": {"body": "wheel", "radius": RADIUS}},
            "surfaces": {"ground": {"height": height}},
            **more,
        }
    )


def two(shape: dict[str, Any], contact: dict[str, Any]) -> Mechanism:
    """A floating body with a shape, and one that may touch it."""
    return machine(
        {
            "bodies": {"one": {"mass": 1, "inertia": 0.1}, "other": {"mass": 1, "inertia": 0.1}},
            "joints": {
                "a": {"kind": "floating", "child": "one"},
                "b": {"kind": "floating", "child": "other"},
            },
            "shapes": {"edge": {"body": "one", **shape}},
            "contacts": {"tip": {"body": "other", **contact}},
            "pairs": {"touch": {"contact": "tip", "against": "edge"}},
        }
    )


def slip(mechanism: Mechanism, path: Callable[[float], list[float]], h: float = 0.4) -> float:
    """The slip of the only pair over a step along a path of coordinates."""
    steps = Steps(mechanism)
    q = np.array([path(t) for t in (-0.1, 0.0, h)])
    return float(steps.rows(Instance(q, 0.1, h, {}))[1][0])


@pytest.mark.parametrize("slope", [0.0, 0.5, -1.3])
def test_a_wheel_rolls_on_level_and_sloped_ground(slope: float) -> None:
    along = np.array([1, slope]) / np.hypot(1, slope)
    up = np.array([-along[1], along[0]])

    def rolling(t: float) -> list[float]:
        angle = 0.2 - 7 * t
        return [*(RADIUS * up - RADIUS * angle * along), angle]

    def skidding(t: float) -> list[float]:
        return [*(RADIUS * up + 3 * t * along), 0.2]

    on = wheel(f"{slope}*x")
    assert slip(on, rolling) == pytest.approx(0, abs=1e-13)
    assert slip(on, skidding) == pytest.approx(3)
    assert slip(on, lambda t: [*(RADIUS * up), 5 * t]) == pytest.approx(5 * RADIUS)


@pytest.mark.parametrize("spins", [(0.0, 4.0), (-2.0, 0.0), (1.5, 5.0), (3.0, -2.0)])
def test_a_disk_rolls_on_a_disk_that_turns_and_travels(spins: tuple[float, float]) -> None:
    """Of two gears (R, b) and (r, a) whose middles turn by f: ``r a + R b = (R + r) f``."""
    turning, spin = spins
    swing = (RADIUS * spin + OTHER * turning) / (RADIUS + OTHER)

    def gears(t: float) -> list[float]:
        middle = [0.7 * t, 1 - 2 * t**2]
        arm = 0.4 + swing * t
        reach = (OTHER + RADIUS) * np.array([np.cos(arm), np.sin(arm)])
        return [*middle, 0.1 + turning * t, *(middle + reach), spin * t]

    def stuck(t: float) -> list[float]:
        still = gears(0.0)
        return [*still[:5], spin * t]

    on = two({"circle": OTHER}, {"radius": RADIUS})
    assert slip(on, gears) == pytest.approx(0, abs=1e-13)
    assert slip(on, stuck) == pytest.approx(RADIUS * spin, abs=1e-13)


@pytest.mark.parametrize("shape", [{"circle": 0.6}, {"ellipse": [0.6, 0.2]}])
@pytest.mark.parametrize("radius", [0, 0.1])
def test_what_moves_with_a_shape_slips_nowhere(shape: dict[str, Any], radius: float) -> None:
    """By two radians in a step, off the middle, and along."""

    def together(t: float) -> list[float]:
        angle = 0.3 + 5 * t
        middle = np.array([t, 2 * t])
        return [*middle, angle, *(middle + turn(angle) @ [0.5, 0.4]), angle]

    on = two({"at": [0.1, -0.05], **shape}, {"radius": radius})
    assert slip(on, together) == pytest.approx(0, abs=1e-13)


@pytest.mark.parametrize("h", [1e-2, 1e-3])
def test_a_point_on_an_ellipse_goes_by_its_arcs(h: float) -> None:
    """To second order in the step, clockwise, while the ellipse turns and travels."""
    a, b = 0.6, 0.2

    def walking(t: float) -> list[float]:
        angle, middle = 0.3 + 2 * t, np.array([t, -t])
        spot = [a * np.cos(1 - 3 * t), b * np.sin(1 - 3 * t)]
        return [*middle, angle, *(middle + turn(angle) @ spot), 0.0]

    at = np.linspace(1, 1 - 3 * h, 2001)
    arc = np.hypot(np.diff(a * np.cos(at)), np.diff(b * np.sin(at))).sum()
    on = two({"ellipse": [a, b]}, {})
    assert slip(on, walking, h) * h == pytest.approx(arc, abs=20 * h**3)


@pytest.mark.parametrize("name", ["level", "sloped", "ball", "egg", "hill"])
def test_slips_are_the_equations_own_in_small_steps(name: str) -> None:
    """To first order, whatever the motion."""
    on = {
        "level": wheel(),
        "sloped": wheel("0.5*x"),
        "hill": wheel("sin(x)"),
        "ball": two({"circle": 0.4, "at": [0.1, 0.2]}, {"radius": 0.1, "at": [0.05, 0]}),
        "egg": two({"ellipse": [0.4, 0.7], "at": [0.1, 0.2]}, {"radius": 0.1, "at": [0.05, 0]}),
    }[name]
    steps = Steps(on)
    rng = np.random.default_rng(4)
    q, v = rng.normal(size=(2, len(on.coordinates)))
    errors = []
    for h in (1e-3, 1e-4):
        one = Instance(np.array([q - h * v, q, q + h * v]), h, h, {})
        errors.append(
            abs(steps.rows(one)[1][0] - steps.end(f"contact.{next(iter(on.touching))}.slip", one))
        )
    assert errors[0] < 0.05
    assert errors[1] < 0.15 * errors[0] + 1e-12
