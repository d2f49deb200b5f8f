"""Smooth simulations: closed forms, energies, what steers them, how they end."""

import math
from typing import Any

import numpy as np
import pytest

from footfall.curves import Curves
from schemas.errors import InvalidModel
from schemas.events import EngineEvent
from schemas.expressions import Name
from schemas.simulated import SimulationResult, SimulationStatus
from schemas.simulations import read_simulation
from solver.simulation import results, simulate
from solver.simulation.scope import Vocabulary
from tests.support.machines import cart_pole, chain, double_pendulum, machine

OSCILLATOR: dict[str, Any] = {
    "kind": "ode",
    "parameters": {"w": 3.0},
    "states": ["x", "v"],
    "controls": ["u"],
    "derivatives": {"x": "v", "v": "-w^2*x + u"},
}


def run(system: Any, duration: float | str, **more: Any) -> SimulationResult:
    document = system if isinstance(system, dict) else system.model_dump(mode="json")
    return simulate(read_simulation({"system": document, "duration": duration, **more}))


def last(result: SimulationResult, group: str = "states") -> dict[str, float | None]:
    return {name: row[-1] for name, row in result.phases[0].groups[group].values.items()}


def curves(result: SimulationResult, group: str = "states") -> Curves:
    return Curves.from_dict(result.phases[0].curves[group].model_dump())


def test_an_oscillator_swings() -> None:
    result = run(OSCILLATOR, 2.0, initial={"x": "1/2"}, samples=5)
    assert result.status is SimulationStatus.FINISHED
    assert result.phases[0].groups["states"].time == [0, 0.5, 1, 1.5, 2]
    t = np.linspace(0, 2, 333)
    np.testing.assert_allclose(curves(result)["x"](t), 0.5 * np.cos(3 * t), atol=1e-8)
    assert last(result)["x"] == pytest.approx(0.5 * math.cos(6), abs=1e-9)
    assert result.energy is None
    assert result.mode_sequence is None


@pytest.mark.parametrize(
    "given",
    [
        {"accelerations": {"x": "-w^2*x + u"}},
        {"residual": ["2*dd(x) + 2*w^2*x - 2*u"]},
        {"residual": ["dd(x)^3 + dd(x) + (w^2*x - u)*(1 + (w^2*x - u)^2)"]},
    ],
)
def test_second_order_systems_are_the_same_motion(given: dict[str, Any]) -> None:
    system = {
        "kind": "second_order",
        "parameters": {"w": 3.0},
        "coordinates": ["x"],
        "controls": ["u"],
        **given,
    }
    control = {"kind": "expressions", "values": {"u": "-0.8*d(x)"}}
    result = run(system, 2.0, initial={"x": 0.5}, controls=control)
    damped = run(
        OSCILLATOR,
        2.0,
        initial={"x": 0.5},
        controls={"kind": "expressions", "values": {"u": "-0.8*v"}},
    )
    assert last(result)["x"] == pytest.approx(last(damped)["x"], abs=1e-9)
    assert last(result)["d(x)"] == pytest.approx(last(damped)["v"], abs=1e-8)


@pytest.mark.parametrize(
    ("build", "initial"),
    [
        (double_pendulum, {"shoulder": 2.0, "elbow": 0.5}),
        (cart_pole, {"q2": 2.5, "d(q1)": 0.3}),
        (
            chain,
            {"hinge": 0.9, "slide": -0.2, "first.d(x)": 1.0, "first.d(angle)": -2.0, "d(slide)": 1},
        ),
    ],
)
@pytest.mark.parametrize("angles", ["relative", "absolute"])
def test_unactuated_mechanisms_keep_their_energy(
    build: Any, initial: dict[str, Any], angles: str
) -> None:
    names = {"hinge": "second.angle", "shoulder": "upper.angle", "elbow": "lower.angle"}
    names |= {"q2": "pole.angle"}
    if angles == "absolute":
        initial = {names.get(name, name): value for name, value in initial.items()}
    result = run(
        build(angles=angles), 10.0, initial=initial, method={"kind": "smooth", "tolerance": 1e-11}
    )
    assert result.status is SimulationStatus.FINISHED
    assert result.energy is not None
    assert result.energy.drift is not None
    assert result.energy.drift < 1e-9


def test_a_loop_keeps_its_energy_and_stays_closed() -> None:
    bar = {"mass": 1, "inertia": 0.1, "com": [0.5, 0]}
    four_bar = machine(
        {
            "bodies": {"crank": bar, "coupler": bar, "rocker": bar},
            "joints": {
                "a": {"kind": "revolute", "child": "crank"},
                "b": {"kind": "revolute", "parent": "crank", "child": "coupler", "at": [1, 0]},
                "d": {"kind": "revolute", "child": "rocker", "at": [2, 0]},
            },
            "loops": {
                "c": {
                    "between": [
                        {"body": "coupler", "at": [2.2, 0]},
                        {"body": "rocker", "at": [1.5, 0]},
                    ]
                }
            },
        }
    )
    # the crank is up, at (0, 1); from there to the rocker's pin the law of cosines
    across, down = math.sqrt(5), math.atan2(-1, 2)
    inner = math.acos((across**2 + 2.2**2 - 1.5**2) / (2 * across * 2.2))
    meet = 1j + 2.2 * np.exp(1j * (down + inner))
    start = {"a": "pi/2", "b": down + inner - math.pi / 2, "d": float(np.angle(meet - 2))}
    result = run(four_bar, 2.0, initial=start)
    assert result.energy is not None
    assert result.energy.drift is not None
    assert result.energy.drift < 1e-9
    a, b, d = (float(last(result)[name] or 0) for name in ("a", "b", "d"))
    end = np.exp(1j * a) + 2.2 * np.exp(1j * (a + b))
    assert abs(end - (2 + 1.5 * np.exp(1j * d))) < 1e-9
    assert abs(a - math.pi / 2) > 1
    assert set(result.phases[0].groups["forces"].values) == {"loop.c.x", "loop.c.y"}


def test_held_controls_act_from_their_time_to_the_next() -> None:
    system = {"kind": "ode", "states": ["x"], "controls": ["u"], "derivatives": {"x": "u"}}
    signal = {"kind": "samples", "time": [1, 2, 3], "values": {"u": [1.0, 10.0, 100.0]}}

    def at_end(duration: float, interpolation: str) -> float:
        controls = {**signal, "interpolation": interpolation}
        return float(last(run(system, duration, controls=controls))["x"] or 0)

    assert at_end(4.5, "hold") == pytest.approx(1 + 1 + 10 + 150, rel=1e-12)
    assert at_end(4.5, "linear") == pytest.approx(1 + 5.5 + 55 + 150, rel=1e-12)


def test_a_cubic_goes_through_its_samples() -> None:
    times = np.linspace(0, 2, 9)
    signal = {"kind": "samples", "time": times.tolist(), "interpolation": "cubic"}
    controls = {**signal, "values": {"u": (times**3 - times).tolist()}}
    result = run(OSCILLATOR, 2.0, controls=controls)
    t = np.linspace(0, 2, 50)
    np.testing.assert_allclose(curves(result, "controls")["u"](t), t**3 - t, atol=1e-12)


def test_an_earlier_result_is_played_and_followed() -> None:
    controls = {"kind": "expressions", "values": {"u": "sin(5*t)"}}
    first = run(OSCILLATOR, 2.0, initial={"x": 1}, controls=controls)
    phase = first.phases[0].model_dump(mode="json")
    played = {"kind": "solution", "phases": [{k: phase[k] for k in ("name", "curves")}]}
    again = run(OSCILLATOR, 2.0, initial={"x": 1}, controls=played)
    assert last(again)["x"] == pytest.approx(last(first)["x"], abs=1e-8)
    off = run(OSCILLATOR, 2.0, initial={"x": 1.1}, controls=played)
    gains = {"gains": {"u": {"x": 40, "v": "14 + t*0"}}}
    led = run(OSCILLATOR, 2.0, initial={"x": 1.1}, controls=played, feedback=gains)
    miss = [abs(float(last(one)["x"] or 0) - float(last(first)["x"] or 0)) for one in (off, led)]
    assert miss[0] > 0.05
    assert miss[1] < 1e-4


def test_gains_follow_their_schedule() -> None:
    system = {"kind": "ode", "states": ["x"], "controls": ["u"], "derivatives": {"x": "u"}}
    schedule = {"time": [0, 1, 2], "gains": {"u": {"x": [0.0, 2.0, 2.0]}}}
    result = run(system, 2.0, initial={"x": 1}, feedback={"schedule": schedule})
    assert last(result)["x"] == pytest.approx(math.exp(-1 - 2), rel=1e-9)
    reference = {"kind": "expressions", "values": {"x": "3 + t"}}
    lead = run(system, 9.0, feedback={"gains": {"u": {"x": 5}}, "reference": reference})
    assert last(lead)["x"] == pytest.approx(12 - 1 / 5, rel=1e-9)


def test_statics_and_the_start_are_given() -> None:
    system = {"kind": "ode", "states": ["x"], "derivatives": {"x": "k*t"}}
    result = run(system, "1 + 1", static={"k": "6/2"}, start=1)
    assert result.phases[0].knots == [1, 3]
    assert last(result)["x"] == pytest.approx(3 * (9 - 1) / 2)


def test_derivatives_of_intermediates_are_made() -> None:
    system = {
        "kind": "ode",
        "states": ["x", "y"],
        "define": {"p": "x^2", "rate": "d(p) + d(x)"},
        "derivatives": {"x": "1", "y": "rate + dd(p)"},
    }
    result = run(system, 2.0)
    assert last(result)["y"] == pytest.approx(4 + 2 + 4)


def test_a_motion_that_blows_up_ends_where_it_does() -> None:
    system = {"kind": "ode", "states": ["x"], "derivatives": {"x": "x^2"}}
    result = run(system, 2.0, initial={"x": 1})
    assert result.status is SimulationStatus.DIVERGED
    assert "x changes by" in result.message
    assert result.phases[0].knots[-1] == pytest.approx(1.0, abs=1e-6)


def test_rates_without_a_value_are_named() -> None:
    system = {
        "kind": "ode",
        "states": ["x", "y"],
        "derivatives": {"x": "-1", "y": "sqrt(x)"},
    }
    started = run(system, 2.0, initial={"x": -1})
    assert started.status is SimulationStatus.INVALID_NUMBER
    assert "rate of y" in started.message
    assert last(started) == {"x": -1, "y": 0}
    later = run(system, 2.0, initial={"x": 1})
    assert later.status in (SimulationStatus.INVALID_NUMBER, SimulationStatus.DIVERGED)
    assert later.phases[0].knots[-1] == pytest.approx(1.0, abs=1e-6)


def test_the_deadline_and_the_caller_end_it_between_steps() -> None:
    simulation = read_simulation({"system": OSCILLATOR, "duration": 100, "initial": {"x": 1}})
    asked = iter([False] * 5)
    result = simulate(simulation, should_stop=lambda: next(asked, True))
    assert result.status is SimulationStatus.CANCELLED
    assert result.timing.steps == 6
    late = simulate(simulation, deadline=0.0)
    assert late.status is SimulationStatus.TIME_LIMIT
    assert late.timing.steps == 1


def test_the_stages_are_told() -> None:
    events: list[EngineEvent] = []
    simulation = read_simulation({"system": OSCILLATOR, "duration": 1})
    result = simulate(simulation, on_event=events.append)
    assert [event.stage for event in events if event.type == "stage"] == ["build", "simulate"]
    assert len(result.reproduce.spec_sha256) == 64
    assert result.timing.evaluations > 0


def test_a_contact_of_the_mode_is_held() -> None:
    system = machine(
        {
            "bodies": {"stick": {"mass": 1, "inertia": 1 / 12}},
            "joints": {"free": {"kind": "floating", "child": "stick"}},
            "contacts": {"foot": {"body": "stick", "at": [0, -0.5]}},
            "mode": {"foot": "sticking"},
        }
    )
    start = {"stick.y": "0.5*cos(0.1)", "stick.x": "-0.5*sin(0.1)", "stick.angle": 0.1}
    result = run(system, 0.5, initial=start)
    angle = float(last(result)["stick.angle"] or 0)
    fallen = machine(
        {
            "bodies": {"stick": {"mass": 1, "inertia": 1 / 12, "com": [0, 0.5]}},
            "joints": {"pin": {"kind": "revolute", "child": "stick"}},
        }
    )
    pinned = run(fallen, 0.5, initial={"pin": 0.1})
    assert angle == pytest.approx(float(last(pinned)["pin"] or 0), abs=1e-9)
    forces = result.phases[0].groups["forces"].values
    assert set(forces) == {"contact.foot.normal", "contact.foot.tangential"}
    assert result.phases[0].frames is not None


@pytest.mark.parametrize(
    ("system", "name", "formula"),
    [
        (OSCILLATOR, "u", "-d(v)"),
        (cart_pole(), "motor.drive.torque", "-dd(q2)"),
        (cart_pole(), "motor.drive.torque", "-motor.drive.power"),
    ],
)
def test_a_control_that_follows_from_itself_is_refused(
    system: Any, name: str, formula: str
) -> None:
    controls = {"kind": "expressions", "values": {name: formula}}
    with pytest.raises(InvalidModel) as caught:
        run(system, 1.0, controls=controls)
    assert caught.value.issues[0].pointer == f"/controls/values/{name}"


def test_definitions_in_a_circle_are_refused() -> None:
    """The language lets no intermediate use a later one; the model asks again."""
    words = Vocabulary({}, {"a": Name("b"), "b": Name("a")}, lambda _: False)
    with pytest.raises(InvalidModel, match="define each other"):
        words.record([Name("a")])


def test_very_many_steps_make_no_endless_curves(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(results, "MAX_PIECES", 7)
    thinned = run(OSCILLATOR, 2.0, initial={"x": 0.5})
    assert thinned.timing.steps > 14
    curve = thinned.phases[0].curves["states"]
    assert len(curve.breaks) <= 8
    assert "steps in each piece" in thinned.warnings[0]
    t = np.linspace(0, 2, 50)
    np.testing.assert_allclose(curves(thinned)["x"](t), 0.5 * np.cos(3 * t), atol=1e-4)


@pytest.mark.parametrize("doing", ["frictionless", "sticking"])
def test_a_wheel_in_a_hollow_keeps_its_energy(doing: str) -> None:
    hollow = machine(
        {
            "bodies": {"wheel": {"mass": 1, "inertia": 0.05}},
            "joints": {"free": {"kind": "floating", "child": "wheel"}},
            "contacts": {"rim": {"body": "wheel", "radius": 0.3}},
            "surfaces": {"ground": {"height": "0.2*x^2"}},
            "mode": {"rim": doing},
        }
    )
    start = {"wheel.x": 0.5, "wheel.y": "0.05 + 0.3*sqrt(1.04)"}
    result = run(hollow, 1.0, initial=start)
    assert abs(last(result)["wheel.x"] or 0) < 0.45
    assert result.energy is not None
    assert result.energy.drift is not None
    assert result.energy.drift < 1e-9


def test_what_is_held_starts_in_its_place() -> None:
    system = machine(
        {
            "bodies": {"stick": {"mass": 1, "inertia": 1}},
            "joints": {"free": {"kind": "floating", "child": "stick"}},
            "contacts": {"foot": {"body": "stick", "at": [0, -0.5]}},
            "loops": {"pin": {"between": [{"body": "ground"}, {"body": "stick"}]}},
            "mode": {"foot": "sticking"},
        }
    )
    with pytest.raises(InvalidModel) as caught:
        run(system, 1.0, initial={"stick.y": 0.6, "stick.d(x)": 0.1})
    assert [issue.message for issue in caught.value.issues] == [
        "the gap of contact 'foot', m, is 0.1 at the start",
        "the slip of contact 'foot', m/s, is 0.1 at the start",
        "the loop 'pin', of 'ground' and 'stick', is open by 0.6 m at the start",
    ]
