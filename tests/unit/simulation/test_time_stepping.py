"""Time stepping: contacts, limits and loops in fixed steps."""

import math
from typing import Any

import numpy as np
import pytest

from schemas.errors import InvalidModel
from schemas.simulated import SimulationStatus
from tests.support.touching import block, box, example, forces, last, modes, run, told

G = 9.81
STEPS = {"kind": "time_stepping", "step": 1e-3}


def test_a_block_slides_to_rest_and_stays() -> None:
    result = run(block(0.3), 2.0, STEPS, initial={"d(across)": 3})
    assert modes(result) == [{"skin": "sliding_right"}, {"skin": "sticking"}]
    assert told(result, "stick")[0].time == pytest.approx(3 / (0.3 * G), abs=1e-3)
    assert last(result)["across"] == pytest.approx(9 / (2 * 0.3 * G), abs=3e-3)
    assert last(result)["d(across)"] == pytest.approx(0, abs=1e-12)


def test_rest_is_exact() -> None:
    result = run(box(0.6), 1.0, STEPS, initial={"box.y": 0.25})
    state = last(result)
    assert state["box.y"] == pytest.approx(0.25, abs=1e-12)
    assert state["box.d(y)"] == pytest.approx(0, abs=1e-12)
    both = np.array(forces(result, "contact.left.normal"))
    both += np.array(forces(result, "contact.right.normal"))
    np.testing.assert_allclose(both, 3 * G, rtol=1e-9)


def test_forces_stay_in_their_cones() -> None:
    result = run(box(0.4), 1.0, STEPS, initial={"box.y": 0.5, "box.angle": 0.3, "box.d(x)": 2})
    for side in ("left", "right"):
        normal = np.array(forces(result, f"contact.{side}.normal"))
        tangential = np.array(forces(result, f"contact.{side}.tangential"))
        assert np.all(normal >= 0)
        assert np.all(np.abs(tangential) <= 0.4 * normal + 1e-9)
        assert normal.max() > 0


def test_joints_stop_at_their_limits() -> None:
    pendulum = {
        "kind": "mechanism",
        "bodies": {"rod": {"mass": 1, "inertia": 0.1, "com": [0, -1]}},
        "joints": {"hinge": {"kind": "revolute", "child": "rod", "limits": [0.2, 2]}},
    }
    result = run(pendulum, 3.0, STEPS, initial={"hinge": 1.0})
    assert last(result)["hinge"] == pytest.approx(0.2, abs=1e-9)
    assert forces(result, "limit.hinge.lower")[-1] == pytest.approx(G * math.sin(0.2), rel=1e-6)


def test_loops_stay_closed() -> None:
    rod = {"mass": 1, "inertia": 0.1}
    system: dict[str, Any] = {
        "kind": "mechanism",
        "bodies": {"a": {**rod, "com": [0.5, 0]}, "b": {**rod, "com": [0.5, 0]}},
        "joints": {
            "left": {"kind": "revolute", "child": "a"},
            "right": {"kind": "revolute", "parent": "a", "child": "b", "at": [1, 0]},
            "slide": {"kind": "prismatic", "child": "c", "axis": [1, 0]},
        },
        "loops": {"pin": {"between": [{"body": "b", "at": [1, 0]}, {"body": "c"}]}},
    }
    system["bodies"]["c"] = {"mass": 1, "inertia": 1}
    start = {"left": 1.0, "right": -2.0, "slide": 2 * math.cos(1.0)}
    result = run(system, 0.3, STEPS, initial=start)
    state = last(result)
    tip = math.sin(state["left"]) + math.sin(state["left"] + state["right"])
    assert abs(tip) < 1e-5
    along = math.cos(state["left"]) + math.cos(state["left"] + state["right"])
    assert along == pytest.approx(state["slide"], abs=1e-5)
    exact = last(run(system, 0.3, {"kind": "events"}, initial=start))
    assert state["slide"] == pytest.approx(exact["slide"], abs=1e-3)


def test_a_bounce_keeps_its_share_of_the_speed() -> None:
    result = example("bouncing_ball", STEPS)
    first = told(result, "impact")[0]
    assert first.gap_rate is not None
    assert first.gap_rate[1] == pytest.approx(-0.5 * first.gap_rate[0], rel=1e-9)
    assert last(result)["ball.y"] == pytest.approx(0.1, abs=1e-6)


def test_a_contact_on_a_curved_way_does_not_flicker() -> None:
    assert modes(example("painleve_rod")) == [{"tip": "sticking"}]


def test_the_last_step_ends_at_the_end() -> None:
    result = run(block(0.3), 0.1234, STEPS)
    assert result.phases[0].groups["states"].time[-1] == 0.1234
    assert result.timing.steps == 124


def test_numbers_that_are_none_are_a_status() -> None:
    controls = {"kind": "expressions", "values": {"fx": "log(-1 - t)", "fy": "0"}}
    result = run(block(0.3), 0.1, STEPS, controls=controls)
    assert result.status is SimulationStatus.INVALID_NUMBER


def test_a_start_below_the_ground_is_refused() -> None:
    with pytest.raises(InvalidModel):
        run(block(0.5), 1.0, STEPS, initial={"up": -0.1})
