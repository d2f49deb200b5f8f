"""Simulations say what they do not heed, and refuse what they cannot start."""

from typing import Any

import pytest

from schemas.errors import BadProblem, InvalidModel
from schemas.simulated import SimulationStatus
from tests.support.touching import example, run

SMOOTH = {"kind": "smooth"}


def ball(**more: Any) -> dict[str, Any]:
    return {
        "kind": "mechanism",
        "bodies": {"ball": {"mass": 1, "inertia": 0.004}},
        "joints": {"free": {"kind": "floating", "child": "ball"}},
        "contacts": {"skin": {"body": "ball"}},
        "surfaces": {"floor": {"friction": 0.5}},
    } | more


@pytest.mark.parametrize("height", ["abs(x)", "max(x, 0)"])
def test_kinks_are_refused_where_contacts_are_held(height: str) -> None:
    ground = ball(surfaces={"floor": {"height": height}})
    with pytest.raises(BadProblem) as caught:
        run(ground, 1.0)
    assert caught.value.issues[0].pointer == "/system/surfaces/floor/height"


@pytest.mark.parametrize(
    ("system", "initial", "pointer"),
    [
        (ball(surfaces={"floor": {"height": "sqrt(x - 1)"}}), {}, "/system/surfaces/floor/height"),
        (ball(bodies={"ball": {"mass": 1, "inertia": 0}}), {}, "/system/bodies/ball/inertia"),
        (ball(), {"ball.y": -0.1}, "/initial"),
    ],
)
def test_impossible_starts(system: dict[str, Any], initial: Any, pointer: str) -> None:
    with pytest.raises(InvalidModel) as caught:
        run(system, 1.0, initial=initial)
    assert caught.value.issues[0].pointer == pointer


def test_a_slip_against_the_mode() -> None:
    system = ball(mode={"skin": "sliding_right"})
    with pytest.raises(InvalidModel) as caught:
        run(system, 1.0, SMOOTH, initial={"ball.d(x)": -1})
    assert caught.value.issues[0].pointer == "/system/mode/skin"
    later = run(system, 1.0, SMOOTH, initial={"ball.d(x)": 1})
    assert "t = 0.2039 s" in later.warnings[0]  # 1 m/s over 0.5 g
    assert later.energy is not None
    assert later.energy.drift is None


def test_a_contact_outside_the_mode_is_told() -> None:
    result = run(ball(), 1.0, SMOOTH, initial={"ball.y": 1})
    assert "'skin', which is not in the mode" in result.warnings[0]


def test_who_tunnels_has_not_finished() -> None:
    result = example("ball_on_hills", {"kind": "events", "max_step": 0.3})
    assert result.status is SimulationStatus.DIVERGED


@pytest.mark.parametrize("kind", ["smooth", "events"])
def test_a_start_without_rates_is_kept(kind: str) -> None:
    system = {"kind": "ode", "states": ["x"], "derivatives": {"x": "1/x"}}
    result = run(system, 1.0, {"kind": kind})
    assert result.status is SimulationStatus.INVALID_NUMBER
    assert result.phases[0].knots == [0]
    assert "x = 0" in result.message


@pytest.mark.parametrize("restitution", [2, -1])
def test_a_restitution_of_a_method(restitution: float) -> None:
    with pytest.raises(BadProblem) as caught:
        run(ball(), 1.0, {"kind": "events", "restitution": restitution})
    assert caught.value.issues[0].pointer == "/method/restitution"


def test_more_steps_than_there_may_be() -> None:
    with pytest.raises(BadProblem) as caught:
        run(ball(), 1.0, {"kind": "time_stepping", "step": 1e-6})
    assert caught.value.issues[0].pointer == "/method/step"
