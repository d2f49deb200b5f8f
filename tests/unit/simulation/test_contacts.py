"""Contacts by events: what opens, closes, sticks, slides and parts, and when."""

import math
from typing import Any

import numpy as np
import pytest

from schemas.errors import InvalidModel
from schemas.simulated import SimulationResult, SimulationStatus
from tests.support.touching import block, box, example, forces, last, modes, run, told

G = 9.81


def happened(result: SimulationResult) -> list[Any]:
    return [(event.kind, event.time) for event in result.events]


def push(fx: str = "0", fy: str = "0") -> dict[str, Any]:
    return {"kind": "expressions", "values": {"fx": fx, "fy": fy}}


def test_a_block_slides_to_rest_and_stays() -> None:
    result = run(block(0.3), 2.0, initial={"d(across)": 3})
    stop = 3 / (0.3 * G)
    assert happened(result) == [("stick", pytest.approx(stop, abs=1e-9))]
    assert modes(result) == [{"skin": "sliding_right"}, {"skin": "sticking"}]
    assert last(result)["across"] == pytest.approx(9 / (2 * 0.3 * G), abs=1e-9)
    assert last(result)["d(across)"] == pytest.approx(0, abs=1e-12)


def test_a_push_beyond_the_cone_slides() -> None:
    result = run(block(0.5), 2.0, controls=push("10*t"))
    assert happened(result) == [("slip", pytest.approx(0.5 * 2 * G / 10, abs=1e-8))]
    assert modes(result)[-1] == {"skin": "sliding_right"}
    slip = 2.0 - 0.5 * 2 * G / 10
    assert last(result)["d(across)"] == pytest.approx(5 * slip**2 / 2, abs=1e-7)


def test_a_slide_turns_round_where_friction_does_not_hold() -> None:
    result = run(block(0.2, slope=1.0), 2.0, initial={"d(across)": 1, "d(up)": 1})
    assert modes(result) == [{"skin": "sliding_right"}, {"skin": "sliding_left"}]
    # Along the slope: g (sin + mu cos) up, g (sin - mu cos) down.
    up = math.sqrt(2) / (G * math.sqrt(0.5) * 1.2)
    assert result.events[0].time == pytest.approx(up, abs=1e-9)
    down = G * math.sqrt(0.5) * 0.8 * (2.0 - up)
    assert last(result)["d(across)"] == pytest.approx(-down * math.sqrt(0.5), abs=1e-8)


def test_a_block_on_a_slope_within_the_cone_stays() -> None:
    result = run(block(0.51, slope=0.5), 3.0)
    assert modes(result) == [{"skin": "sticking"}]
    assert last(result)["across"] == pytest.approx(0, abs=1e-12)
    normal, tangential = (
        forces(result, "contact.skin.normal"),
        forces(result, "contact.skin.tangential"),
    )
    assert normal[-1] == pytest.approx(2 * G / math.sqrt(1.25))
    assert tangential[-1] == pytest.approx(G / math.sqrt(1.25))


def test_a_lift_that_grows_frees_the_block() -> None:
    result = run(block(0.5), 2.5, controls=push(fy="10*t"))
    assert happened(result) == [("lift", pytest.approx(2 * G / 10))]
    air = 2.5 - 2 * G / 10
    assert last(result)["up"] == pytest.approx(5 * air**3 / 6, rel=1e-6)


def test_a_jump_of_the_controls_frees_and_brings_back() -> None:
    controls = {
        "kind": "samples",
        "time": [0, 0.5, 1.0, 2.0],
        "values": {"fy": [0, 30, 0, 0], "fx": [0, 0, 0, 0]},
        "interpolation": "hold",
    }
    result = run(block(0.5), 3.0, controls=controls)
    assert [e.kind for e in result.events] == ["lift", "impact"]
    assert result.events[0].time == pytest.approx(0.5, abs=1e-9)
    a = 15 - G  # half a second of it, then free fall
    v, h = a * 0.5, a * 0.125
    fall = (v + math.sqrt(v**2 + 2 * G * h)) / G
    assert result.events[1].time == pytest.approx(1.0 + fall, abs=1e-9)


def test_a_box_on_two_corners_shares_its_friction() -> None:
    # Four contact forces, three equations: no singular system, and the cone of both together.
    result = run(box(0.4), 2.0, initial={"box.y": 0.25, "box.d(x)": 1})
    assert modes(result) == [
        {"left": "sliding_right", "right": "sliding_right"},
        {"left": "sticking", "right": "sticking"},
    ]
    assert result.events[0].time == pytest.approx(1 / (0.4 * G), abs=1e-9)
    left, right = (np.array(forces(result, f"contact.{s}.normal")) for s in ("left", "right"))
    np.testing.assert_allclose(left + right, 3 * G, rtol=1e-9)
    assert left[0] < right[0]  # it leans forward as it brakes
    assert last(result)["box.angle"] == pytest.approx(0, abs=1e-10)


def pushed_box(force: str) -> dict[str, Any]:
    side = {"body": "box", "at": [0, -0.25], "direction": [1, 0], "value": force}
    return box(0.5, forces={"hand": {**side, "frame": "world"}})


def test_redundant_contacts_slip_at_the_sum_of_their_cones() -> None:
    result = run(pushed_box("10*t"), 2.0, initial={"box.y": 0.25})
    assert [e.kind for e in result.events] == ["slip", "slip"]
    assert [e.time for e in result.events] == pytest.approx([0.5 * 3 * G / 10] * 2, abs=1e-8)


def test_a_third_contact_between_two_others_carries_nothing_and_stays() -> None:
    system = box(0.5)
    system["contacts"]["middle"] = {"body": "box", "at": [0, -0.25]}
    result = run(system, 1.0, initial={"box.y": 0.25, "box.d(x)": 1})
    assert modes(result)[0] == dict.fromkeys(("left", "right", "middle"), "sliding_right")
    assert modes(result)[-1] == dict.fromkeys(("left", "right", "middle"), "sticking")


def test_a_rocking_block_loses_what_housner_says() -> None:
    result = example("rocking_block")
    rates = [abs(e.gap_rate[0]) for e in told(result, "impact") if e.gap_rate]
    share = 1 - 1.5 * 0.2  # 1 - 3/2 sin^2 of the angle from the side to the diagonal
    ratios = np.array(rates[1:12]) / np.array(rates[:11])
    np.testing.assert_allclose(ratios, share, rtol=1e-9)
    assert result.status is SimulationStatus.FINISHED
    assert modes(result)[-1] == {"left": "sticking", "right": "sticking"}


def test_a_disc_starts_to_roll() -> None:
    disc = {
        "kind": "mechanism",
        "bodies": {"disc": {"mass": 1, "inertia": "1/2"}},
        "joints": {"free": {"kind": "floating", "child": "disc"}},
        "contacts": {"rim": {"body": "disc", "radius": 1}},
        "surfaces": {"ground": {"friction": 0.1}},
    }
    result = run(disc, 3.0, initial={"disc.y": 1, "disc.d(x)": 3})
    assert happened(result) == [("stick", pytest.approx(1 / (0.1 * G)))]
    assert last(result)["disc.d(x)"] == pytest.approx(2.0, abs=1e-9)
    assert last(result)["disc.d(angle)"] == pytest.approx(-2.0, abs=1e-9)


def test_joints_stop_at_their_limits() -> None:
    pendulum = {
        "kind": "mechanism",
        "bodies": {"rod": {"mass": 1, "inertia": 0, "com": [0, -1]}},
        "joints": {"hinge": {"kind": "revolute", "child": "rod", "limits": [-0.5, None]}},
    }
    result = run(pendulum, 3.0, initial={"hinge": 1.0})
    assert result.events[0].kind == "impact"
    assert result.events[0].name == "hinge.lower"
    speed = math.sqrt(2 * G * (math.cos(0.5) - math.cos(1.0)))
    assert result.events[0].normal == pytest.approx(speed, abs=1e-8)
    assert len(result.events) == 1  # all speed is gone: it swings back from there, to 0.5
    hinge = np.array(result.phases[0].groups["states"].values["hinge"], dtype=float)
    assert hinge.min() > -0.5 - 1e-9
    assert hinge[-100:].max() < 0.5 + 1e-9


def test_a_loop_holds_while_its_mechanism_lands() -> None:
    system = {
        "kind": "mechanism",
        "bodies": {"mast": {"mass": 1, "inertia": 0.1}, "bar": {"mass": 1, "inertia": 0.1}},
        "joints": {
            "slide": {"kind": "prismatic", "child": "mast", "axis": [0, 1]},
            "free": {"kind": "floating", "child": "bar"},
        },
        "loops": {"pin": {"between": [{"body": "mast"}, {"body": "bar", "at": [-1, 0]}]}},
        "contacts": {"end": {"body": "bar", "at": [1, 0]}},
        "surfaces": {"ground": {"friction": 0}},
    }
    result = run(system, 2.0, initial={"slide": 1.0, "bar.x": 1, "bar.y": 1})
    # Weight 2 m g falls freely; at the impact the mast goes on and the bar turns about its end.
    assert told(result, "impact")[0].time == pytest.approx(math.sqrt(2 / G), abs=1e-9)
    state = last(result)
    pin = state["bar.y"] - math.sin(state["bar.angle"]) - state["slide"]
    assert abs(pin) < 1e-9
    assert abs(state["bar.x"] - math.cos(state["bar.angle"])) < 1e-9


def test_contacts_of_two_bodies() -> None:
    # A ball falls on a ball that stands still on the ground: as in a row of two masses.
    system = {
        "kind": "mechanism",
        "bodies": {"low": {"mass": 3, "inertia": 1}, "high": {"mass": 1, "inertia": 1}},
        "joints": {
            "a": {"kind": "prismatic", "child": "low", "axis": [0, 1]},
            "b": {"kind": "prismatic", "child": "high", "axis": [0, 1]},
        },
        "contacts": {
            "foot": {"body": "low", "radius": 0.5},
            "top": {"body": "high", "radius": 0.5},
        },
        "shapes": {"round": {"body": "low", "circle": 0.5}},
        "pairs": {
            "ground": {"contact": "foot", "against": "ground", "restitution": 0},
            "both": {"contact": "top", "against": "round", "friction": 0, "restitution": 0.5},
        },
    }
    result = run(system, 0.6, initial={"a": 0.5, "b": 2.5})
    impact = told(result, "impact")
    v = math.sqrt(2 * G)
    assert {e.name for e in impact[:2]} == {"ground", "both"}
    assert impact[0].time == pytest.approx(v / G, abs=1e-9)
    by = {e.name: e for e in impact[:2]}
    assert by["both"].gap_rate == pytest.approx((-v, 0.5 * v), abs=1e-8)
    assert by["ground"].normal == pytest.approx(1.5 * v, abs=1e-8)


def test_momentum_and_energy_through_a_bounce() -> None:
    result = example("bouncing_ball", k=0.8)
    for event in told(result, "impact")[:10]:
        assert event.gap_rate is not None
        before, after = event.gap_rate
        assert after == pytest.approx(-0.8 * before, rel=1e-9)
        assert event.normal == pytest.approx(after - before, rel=1e-9)


def test_restitution_of_the_method_is_that_of_all() -> None:
    result = example("bouncing_ball", {"kind": "events", "restitution": 0})
    assert modes(result) == [{}, {"skin": "sticking"}]
    assert len(result.events) == 1


def test_a_coarse_tolerance_still_ends_at_rest() -> None:
    method = {"kind": "events", "tolerance": 1e-4}
    result = example("toppling_stick", method)
    kinds = [event.kind for event in result.events]
    assert kinds == ["slip", "slip", "guard"]
    result = example("rocking_block", method)
    assert modes(result)[-1] == {"left": "sticking", "right": "sticking"}


def test_painleves_paradox_is_a_status() -> None:
    result = example("painleve_rod", {"kind": "events"})
    assert result.status is SimulationStatus.PAINLEVE
    assert "tip" in result.message
    assert result.advice
    stepped = example("painleve_rod")
    assert stepped.status is SimulationStatus.FINISHED
    below = example("painleve_rod", {"kind": "events"}, mu=0.5)
    assert below.status is SimulationStatus.FINISHED


def test_a_start_below_the_ground_is_refused() -> None:
    with pytest.raises(InvalidModel) as info:
        run(block(0.5), 1.0, initial={"up": -0.1})
    assert info.value.issues[0].pointer == "/initial"
    assert "skin" in info.value.issues[0].message


def test_a_start_into_the_ground_is_an_impact() -> None:
    result = run(block(0.5), 0.1, initial={"d(up)": -1})
    assert told(result, "impact")[0].time == 0
    assert told(result, "impact")[0].normal == pytest.approx(2.0)
