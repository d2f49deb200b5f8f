"""Events that users declare, on any system; automata; how such simulations end."""

import math
from typing import Any

import numpy as np
import pytest

from schemas.errors import InvalidModel
from schemas.simulated import SimulationStatus
from solver.numeric import Array
from solver.simulation.automaton import Flow, Jump, Moment, Stop
from solver.simulation.execution import execute
from solver.simulation.spans import Settings
from tests.support.touching import block, example, last, run, told

BALL: dict[str, Any] = {
    "kind": "ode",
    "states": ["x", "v"],
    "derivatives": {"x": "v", "v": "-9.81"},
}
CLOCK: dict[str, Any] = {"kind": "ode", "states": ["x"], "derivatives": {"x": "cos(t)"}}


class Thermostat:
    """Heats below 20, cools above 22: two modes, and no state that jumps."""

    def begin(self, moment: Moment) -> Jump:
        return Jump("heat", moment.state)

    def flow(self, mode: str, within: float) -> Flow:
        heat, limit = (5.0, 22.0) if mode == "heat" else (0.0, 20.0)
        sign = 1.0 if mode == "heat" else -1.0
        return Flow(
            lambda t, y: heat - 0.1 * (y - 10.0),
            lambda t, y: sign * (limit - y[:1]),
            np.array([True]),
        )

    def jump(self, mode: str, fired: tuple[int, ...], moment: Moment) -> Jump:
        other = "cool" if mode == "heat" else "heat"
        return Jump(other, moment.state, (other,))


def test_a_thermostat_switches_when_it_should() -> None:
    done = execute(Thermostat(), np.array([20.0]), (0.0, 20.0), Settings())
    assert done.status is SimulationStatus.FINISHED
    warm = 10 * math.log(40 / 38)  # from 20 to 22 on the way to 60
    cool = 10 * math.log(12 / 10)
    expected = np.cumsum([warm, cool] * 9)
    times = [record.time for record in done.records]
    np.testing.assert_allclose(times, expected[: len(times)], rtol=1e-9)
    assert done.end == 20.0
    assert [span.mode for span in done.spans[:3]] == ["heat", "cool", "heat"]


def test_an_execution_can_be_halted() -> None:
    stop = Stop(SimulationStatus.CANCELLED, "enough")
    settings = Settings(halt=lambda t, _: stop if t > 3 else None)
    done = execute(Thermostat(), np.array([20.0]), (0.0, 20.0), settings)
    assert done.status is SimulationStatus.CANCELLED
    assert done.end < 20


@pytest.mark.parametrize(
    ("direction", "expected"),
    [
        ("falling", [5 * math.pi / 6, 17 * math.pi / 6]),
        ("rising", [math.pi / 6, 13 * math.pi / 6]),
        ("both", [math.pi / 6, 5 * math.pi / 6, 13 * math.pi / 6, 17 * math.pi / 6]),
    ],
)
def test_a_guard_counts_in_its_direction(direction: str, expected: list[float]) -> None:
    guard = {"name": "half", "expression": "x - 1/2", "direction": direction}
    result = run(CLOCK, 10.0, events=[guard])
    assert [event.name for event in result.events] == ["half"] * len(expected)
    np.testing.assert_allclose([e.time for e in result.events], expected, atol=1e-9)
    assert result.status is SimulationStatus.FINISHED
    assert last(result)["x"] == pytest.approx(math.sin(10), abs=1e-9)


def test_a_guard_that_starts_at_zero_waits() -> None:
    guard = {"name": "zero", "expression": "x", "direction": "falling"}
    result = run(CLOCK, 7.0, events=[guard])  # x rises from zero
    np.testing.assert_allclose([e.time for e in result.events], [math.pi], atol=1e-9)


def test_a_terminal_event_ends_the_motion() -> None:
    guard = {"name": "top", "expression": "v", "terminal": True}
    result = run(BALL, 10.0, initial={"x": 1, "v": 3}, events=[guard])
    assert result.status is SimulationStatus.STOPPED
    assert "top" in result.message
    assert result.phases[0].groups["states"].time[-1] == pytest.approx(3 / 9.81, abs=1e-12)
    assert last(result)["x"] == pytest.approx(1 + 9 / (2 * 9.81), abs=1e-12)


def test_resets_use_the_values_before() -> None:
    guard = {"name": "swap", "expression": "t - 1", "reset": {"a": "b", "b": "a + 10"}}
    system = {"kind": "ode", "states": ["a", "b"], "derivatives": {"a": "0", "b": "0"}}
    result = run(system, 2.0, initial={"a": 1, "b": 2}, events=[guard])
    assert last(result) == {"a": 2, "b": 11}
    time = result.phases[0].groups["states"].time
    assert time.count(1.0) == 2  # before and after


def test_impacts_that_accumulate_are_a_status() -> None:
    result = example("bouncing_ball_guard")
    assert result.status is SimulationStatus.ZENO
    assert result.advice
    first, v0, k = math.sqrt(2 / 9.81), math.sqrt(2 * 9.81), 0.5
    end = result.phases[0].groups["states"].time[-1]
    assert end == pytest.approx(first + 2 * v0 / 9.81 * k / (1 - k), abs=1e-8)


def test_as_many_events_as_allowed() -> None:
    guard = {"name": "tick", "expression": "sin(100*t)"}
    result = run(CLOCK, 10.0, {"kind": "events", "max_events": 5}, events=[guard])
    assert result.status is SimulationStatus.ZENO
    assert len(result.events) == 6
    assert "more than 5 events" in result.message


def test_a_controls_jump_is_seen_by_guards() -> None:
    system = {"kind": "ode", "states": ["x"], "controls": ["u"], "derivatives": {"x": "u"}}
    controls = {
        "kind": "samples",
        "time": [0, 1, 2],
        "values": {"u": [1, -1, -1]},
        "interpolation": "hold",
    }
    guard = {"name": "home", "expression": "x", "direction": "falling"}
    result = run(system, 3.0, events=[guard], controls=controls)
    assert [event.time for event in result.events] == pytest.approx([2.0])


def test_steps_that_vanish_are_a_status() -> None:
    system = {"kind": "ode", "states": ["x"], "derivatives": {"x": "x^2"}}
    result = run(system, 2.0, initial={"x": 1})
    assert result.status is SimulationStatus.DIVERGED


def test_rates_without_value_are_a_status() -> None:
    system = {"kind": "ode", "states": ["x"], "derivatives": {"x": "log(x)"}}
    assert run(system, 2.0, initial={"x": -1}).status is SimulationStatus.INVALID_NUMBER


def test_guards_and_resets_of_a_mechanism() -> None:
    # The user throws the block up again whenever it has slid a metre.
    guard = {
        "name": "kick",
        "expression": "across - 1",
        "direction": "rising",
        "reset": {"across": 0, "d(up)": 2},
    }
    result = run(block(0.0), 2.2, initial={"d(across)": 1}, events=[guard])
    assert [e.time for e in told(result, "guard")] == pytest.approx([1.0, 2.0])
    assert [e.time for e in told(result, "impact")] == pytest.approx([1 + 4 / 9.81])


def test_guards_know_no_contact_force() -> None:
    guard = {"name": "light", "expression": "contact.skin.normal - 1"}
    with pytest.raises(InvalidModel) as info:
        run(block(0.5), 1.0, events=[guard])
    assert info.value.issues[0].pointer == "/events/0/expression"


def height_over_hills(max_step: float) -> Array:
    result = example("ball_on_hills", {"kind": "events", "max_step": max_step})
    states = result.phases[0].groups["states"].values
    x, y = (np.array(states[name], dtype=float) for name in ("ball.x", "ball.y"))
    return np.asarray(y - 0.4 * np.exp(8 * (np.cos(2 * np.pi * x / 0.7) - 1)))


def test_a_coarse_look_tunnels_through_hills_and_the_usual_does_not() -> None:
    assert height_over_hills(0.01).min() > -1e-9
    assert height_over_hills(0.3).min() < -0.05
