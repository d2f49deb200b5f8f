"""003, chapter 6: simulations with sliding and intermittent contact, against its numbers."""

import math

import numpy as np
import pytest

import examples
from schemas.simulations import read_simulation
from solver.simulation import simulate
from tests.support.touching import example, forces, last, modes, told

V0, G = math.sqrt(2 * 9.81), 9.81


@pytest.mark.parametrize("k", [0.3, 0.5, 0.6])
def test_equation_6_5_the_total_time_of_a_bouncing_ball(k: float) -> None:
    result = example("bouncing_ball", k=k)
    impacts = told(result, "impact")
    first = impacts[0].time
    assert first == pytest.approx(V0 / G, abs=1e-9)
    rest = modes(result).index({"skin": "sticking"})
    assert result.mode_sequence is not None
    time = result.mode_sequence.modes[rest].start - first
    # The last impact leaves slower than 1e-6 m/s; what it cuts off lasts 2e-6/g /(1 - k).
    assert time == pytest.approx(2 * V0 / G * k / (1 - k), abs=2.5e-7 / (1 - k))


def test_equation_6_4_every_bounce() -> None:
    impacts = told(example("bouncing_ball"), "impact")
    times = np.diff([event.time for event in impacts[:15]])
    np.testing.assert_allclose(times, 2 * V0 / G * 0.5 ** np.arange(1, 15), rtol=1e-7)


@pytest.mark.parametrize("degrees", [20, 45, 70])
@pytest.mark.parametrize("mu", [0.2, 0.8, 5.0, 1e6])
def test_equation_6_6_the_pull_of_a_dragged_stick(degrees: float, mu: float) -> None:
    theta, weight = math.radians(degrees), 2 * 9.81
    result = example("dragged_stick", mu=mu, theta=theta)
    pull = weight * mu * math.cos(theta) / (2 * math.cos(theta) + mu * math.sin(theta))
    assert last(result)["d(rail)"] == pytest.approx(1.0, abs=1e-9)  # neither faster nor slower
    normal = np.array(forces(result, "contact.tip.normal"))
    np.testing.assert_allclose(normal, pull / mu, rtol=1e-6)
    np.testing.assert_allclose(forces(result, "contact.tip.tangential"), -pull, rtol=1e-6)
    if mu == 1e6:  # equation 6.7: the pull stays finite, the normal force goes
        assert pull == pytest.approx(weight / math.tan(theta), rel=1e-4)
        assert normal.max() < 1e-3 * weight


def test_equation_6_6_holds_for_a_pull_at_the_middle_and_not_at_the_end() -> None:
    # Pulled by its end the stick needs half of the limit: the text does not say where H acts.
    theta, mu, weight = math.pi / 4, 1e6, 2 * 9.81
    result = example("dragged_stick", mu=mu, theta=theta)
    assert last(result)["d(rail)"] == pytest.approx(1.0, abs=1e-9)
    document = examples.load("dragged_stick")
    document["system"]["parameters"] |= {"mu": mu}
    document["system"]["forces"]["pull"] |= {
        "at": [1, 0],
        "value": "W*mu*cos(theta)/(2*cos(theta) + 2*mu*sin(theta))",
    }
    by_end = simulate(read_simulation(document))
    assert last(by_end)["d(rail)"] == pytest.approx(1.0, abs=1e-9)
    np.testing.assert_allclose(
        forces(by_end, "contact.tip.tangential"), -weight / 2 / math.tan(theta), rtol=1e-4
    )


def test_section_6_5_7_a_toppling_point_mass() -> None:
    result = example("toppling_point_mass")
    slip = told(result, "slip")[0]
    states = result.phases[0].groups["states"]
    row = states.time.index(slip.time)
    angle = math.degrees(float(states.values["stick.angle"][row] or 0))
    rate = float(states.values["stick.d(angle)"][row] or 0)
    assert angle == pytest.approx(48.18969, abs=5e-6)  # equation 6.11
    assert rate == pytest.approx(math.sqrt(2 / 3), abs=1e-7)  # equation 6.12
    assert modes(result) == [{"foot": "sticking"}, {"foot": "sliding_left"}]
    state = last(result)
    foot = state["stick.x"] + math.sin(state["stick.angle"])
    assert foot == pytest.approx(-0.124580, abs=5e-7)  # equation 6.19
    exact = 1 - 4 / 27 * math.sqrt(23) - 5 / 27 * math.sqrt(5)
    assert foot == pytest.approx(exact, abs=5e-8)


@pytest.mark.parametrize("inertia", [0.05, 1 / 3, 0.8])
def test_section_6_5_6_energy_and_the_start_from_rest(inertia: float) -> None:
    result = example("toppling_stick", I=inertia, mu=10.0)
    assert result.energy is not None
    assert result.energy.initial == pytest.approx(1.0, abs=1e-12)  # equation 6.9
    # The reaction while it hinges, section 6.5.7: V(theta) with the energy of the upright stick.
    states = result.phases[0].groups["states"]
    normal = np.array(forces(result, "contact.foot.normal"))
    theta = np.array(states.values["stick.angle"], dtype=float)
    hinge = np.array(states.time) < result.events[0].time
    c = np.cos(theta[hinge])
    expected = (inertia - 2 * c + 3 * c**2) / (inertia + 1)
    np.testing.assert_allclose(normal[hinge], expected, atol=1e-8)


def test_section_6_5_8_slipping_both_ways_at_intermediate_friction() -> None:
    result = example("toppling_stick", mu=0.3)
    assert modes(result) == [
        {"foot": "sticking"},
        {"foot": "sliding_right"},
        {"foot": "sliding_left"},
    ]


def test_section_6_5_8_light_sticks_slide_whatever_the_friction_and_heavy_ends_do_not() -> None:
    assert len(told(example("toppling_stick", I=0.1, mu=1e4), "slip")) > 0
    held = example("toppling_stick", I=0.95, mu=1e4)
    foot = last(held)["stick.x"] + math.sin(last(held)["stick.angle"])
    assert abs(foot) < 1e-4


@pytest.mark.parametrize(("mu", "way"), [(0.36, 1), (0.38, -1)])
def test_figure_6_10_a_slender_rod_slips_backward_below_0_371_only(mu: float, way: int) -> None:
    # While it hinges, |H|/V = 9 s (c - 2/3) / (1 - 6 c + 9 c^2) peaks at 0.3706, at 35 degrees.
    result = example("toppling_stick", mu=mu)
    state = result.phases[0].groups["states"]
    slip = told(result, "slip")[0].time
    row = state.time.index(slip)
    later = row + 5  # it has moved by then
    foot = [
        float(state.values["stick.x"][k] or 0)
        + math.sin(float(state.values["stick.angle"][k] or 0))
        for k in (row, later)
    ]
    assert (foot[1] - foot[0]) * way > 0
