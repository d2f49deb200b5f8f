"""The mode sequence of contact-implicit steps, from arrays by hand: what stays, what vanishes."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from footfall.curves import Curves
from schemas.reading import read_problem
from schemas.results import Group, ModeSequence, PhaseResult
from solver.contact.flicker import Pressed, Steps, doing, runs
from solver.contact.sequence import contact_sequence, guessed_sequence, joined
from solver.trajectory import Trajectory
from tests.support.robots import joint, link, robot, system
from tests.support.touching import block

WEIGHT = 2 * 9.81
STEP = 0.05


def said(one: Pressed, lengths: Sequence[float], speed: float = 1.0) -> list[str]:
    """The words without repetition."""
    return [run.word for run in runs(doing(one, Steps(np.array(lengths), WEIGHT, speed)))]


def pressed(
    gaps: Sequence[float], force: Sequence[float], slips: Sequence[float], **more: Any
) -> Pressed:
    """A contact under forces over the weight, in steps of 50 ms; ``gaps`` at their ends, m."""
    normal = STEP * WEIGHT * np.array(force, dtype=float)
    spare = STEP * WEIGHT * np.array(more.get("spare", force), dtype=float)
    return Pressed(np.array([0.0, *gaps]), normal, np.array(slips, dtype=float), spare)


def test_a_block_sticks_slides_and_sticks() -> None:
    one = pressed([0] * 6, [1] * 6, [0, 1e-9, 0.3, 0.4, 1e-9, 0], spare=[0.5, 0.2, 0, 0, 0.3, 1])
    assert said(one, [STEP] * 6) == ["sticking", "sliding_right", "sticking"]


def test_a_kick_of_one_short_step_survives() -> None:
    lengths = [STEP, 1e-3, STEP]
    kick = 0.05 * WEIGHT  # N s: 5 cm/s of the whole machine
    one = Pressed(
        np.array([0.1, 0.05, 0.0, 0.05]), np.array([0.0, kick, 0.0]), np.zeros(3), np.zeros(3)
    )
    assert said(one, lengths) == ["free", "sticking", "free"]


def test_a_touch_that_moves_nothing_vanishes_however_long() -> None:
    steps = 40
    share = 0.9 * 5e-4 / (steps * STEP)  # of the weight: less than half a millisecond of it
    one = pressed([0.0] * steps, [share] * steps, [0.0] * steps)
    assert said(one, [STEP] * steps) == ["free"]


def test_an_opening_that_cannot_be_seen_is_closed_however_long() -> None:
    gaps = [0.0, *([4e-4] * 20), 0.0]
    force = [1.0, *([0.0] * 20), 1.0]
    assert said(pressed(gaps, force, [0.0] * 22), [STEP] * 22) == ["sticking"]


def test_a_flight_of_one_short_step_stays() -> None:
    one = pressed([0.0, 2e-3, 0.0], [1, 0, 1], [0, 1, 0])
    assert said(one, [STEP] * 3) == ["sticking", "free", "sticking"]


def test_a_slide_of_a_hair_vanishes_and_a_fast_one_of_a_step_stays() -> None:
    def slid(speed: float) -> list[str]:
        return said(pressed([0] * 3, [1] * 3, [0, speed, 0], spare=[1, 0, 1]), [STEP] * 3)

    assert slid(0.8 * 5e-4 / STEP) == ["sticking"]
    assert slid(-1.2 * 5e-4 / STEP) == ["sticking", "sliding_left", "sticking"]


def test_chatter_about_a_place_is_sticking() -> None:
    slips = 0.009 * np.resize([1, -1], 12)
    one = pressed([0] * 12, [1] * 12, slips.tolist(), spare=[0] * 12)
    assert said(one, [STEP] * 12) == ["sticking"]


def test_a_stop_between_slides_is_one_only_if_friction_was_spared() -> None:
    def stopped(spare: float) -> list[str]:
        one = pressed([0] * 3, [1] * 3, [0.5, 0.0, 0.5], spare=[0, spare, 0])
        return said(one, [STEP] * 3)

    assert stopped(0.8 * 5e-4 / STEP) == ["sliding_right"]
    assert stopped(1.2 * 5e-4 / STEP) == ["sliding_right", "sticking", "sliding_right"]


def test_of_gap_and_force_the_larger_one_is_not_zero() -> None:
    """A pair that is relaxed only: force over weight times gap is 1e-5 m."""
    far, near = pressed([5e-3], [2e-3], [0.0]), pressed([5e-4], [2e-2], [0.0])
    assert said(far, [STEP]) == ["free"]
    assert said(near, [STEP]) == ["sticking"]


def test_slips_count_against_the_fastest_one() -> None:
    one = pressed([0] * 3, [1] * 3, [0, 0.05, 0], spare=[1, 0, 1])
    assert said(one, [STEP] * 3, speed=1.0) == ["sticking", "sliding_right", "sticking"]
    assert said(one, [STEP] * 3, speed=100.0) == ["sticking"]


def test_in_space_slides_have_no_side_and_circles_are_slides() -> None:
    turn = np.linspace(0.0, 2 * np.pi, 41)[:-1]
    slips = 0.5 * np.array([np.cos(turn), np.sin(turn)])
    one = Pressed(np.zeros(41), np.full(40, WEIGHT * STEP), slips, np.zeros(40))
    assert said(one, [STEP] * 40) == ["sliding"]


def motion(
    across: Sequence[float | None],
    up: Sequence[float | None],
    normal: Sequence[float | None],
    tangential: Sequence[float | None],
    stop: Sequence[float | None] | None = None,
) -> PhaseResult:
    """A block's phase as it is published: places at the knots, forces of the steps."""
    knots = (STEP * np.arange(len(across))).tolist()
    forces = {"contact.skin.normal": list(normal), "contact.skin.tangential": list(tangential)}
    forces |= {} if stop is None else {"limit.across": list(stop)}
    return PhaseResult(
        name="push",
        knots=knots,
        groups={
            "states": Group(time=knots, values={"across": list(across), "up": list(up)}),
            "forces": Group(time=knots[1:], values=forces),
        },
        curves={},
    )


def problem(**more: Any) -> Any:
    """The block, pushed through contact."""
    system = block(0.5, **more)
    ends = {"across": 0, "up": 0, "d(across)": 0, "d(up)": 0}
    document = {
        "name": "block",
        "phases": [
            {
                "name": "push",
                "system": system,
                "time": {"initial": 0, "final": 0.3},
                "initial": ends,
                "integrals": {"effort": "fx^2"},
            }
        ],
        "objective": {"minimize": "push.effort"},
    }
    return read_problem(document).phases[0]


def words(found: ModeSequence | None) -> list[dict[str, str]]:
    assert found is not None
    for before, after in pairwise(found.modes):
        assert before.end == after.start
    return [mode.contacts for mode in found.modes]


def test_a_published_phase_is_read_by_its_places_and_forces() -> None:
    across = [0.0, 0.0, 0.0, -0.1, -0.3, -0.3, -0.3]
    friction = [0.3, 0.2, 0.5, 0.5, 0.4, 0.0]
    result = motion(across, [0.0] * 7, [WEIGHT] * 6, [WEIGHT * share for share in friction])
    found = contact_sequence(problem(), result, {})
    assert words(found) == [{"skin": "sticking"}, {"skin": "sliding_left"}, {"skin": "sticking"}]
    assert found is not None
    assert [mode.start for mode in found.modes] == pytest.approx([0.0, 2 * STEP, 4 * STEP])
    assert found.contacts == ["skin"]
    assert (found.distinct, found.possible) == (2, 4)


def test_stops_are_told_by_their_side() -> None:
    system = {"joints": block(0.5)["joints"]}
    system["joints"]["across"]["limits"] = [-0.1, 0.2]
    across = [0.0, -0.1, 0.0, 0.2, 0.2]
    push = [5.0 * WEIGHT, 0.0, -3.0 * WEIGHT, -WEIGHT]
    result = motion(across, [1.0] * 5, [0.0] * 4, [0.0] * 4, stop=push)
    found = contact_sequence(problem(**system), result, {})
    assert words(found) == [{"limit.across": "lower"}, {}, {"limit.across": "upper"}]
    assert found is not None
    assert found.contacts == ["skin", "limit.across"]
    assert (found.distinct, found.possible) == (3, 4 * 3)


def test_contacts_without_friction_have_no_slides() -> None:
    system = {"surfaces": {"ground": {"friction": 0}}}
    result = motion([0.0, 0.1, 0.2], [0.0] * 3, [WEIGHT] * 2, [0.0] * 2)
    found = contact_sequence(problem(**system), result, {})
    assert words(found) == [{"skin": "frictionless"}]
    assert found is not None
    assert found.possible == 2


def test_a_result_that_diverged_has_a_sequence_all_the_same() -> None:
    result = motion([0.0, None, None], [0.0, None, 1.0], [WEIGHT, None], [0.0, None])
    assert words(contact_sequence(problem(), result, {})) == [{}]


def test_a_guess_without_forces_is_read_by_its_gaps() -> None:
    breaks = STEP * np.arange(5.0)
    places = {"across": [0.0, 0.0, 0.1, 0.2, 0.2], "up": [0.0, 0.0, 0.0, 0.1, 0.0]}
    lines = {
        name: np.column_stack([np.add(rows[:-1], rows[1:]), np.diff(rows)]) / 2
        for name, rows in places.items()
    }
    guess = Trajectory(0.0, 4 * STEP, Curves(breaks, lines), Curves(breaks, {}))
    found = guessed_sequence(problem(), guess, np.linspace(0.0, 1.0, 5), {})
    assert words(found) == [
        {"skin": "sticking"},
        {"skin": "sliding_right"},
        {},
        {"skin": "sticking"},
    ]


def test_phases_join_in_time() -> None:
    first = contact_sequence(problem(), motion([0.0] * 3, [0.0] * 3, [WEIGHT] * 2, [0.0] * 2), {})
    last = contact_sequence(problem(), motion([0.0] * 3, [1.0] * 3, [0.0] * 2, [0.0] * 2), {})
    both = joined([first, None, last])
    assert both is not None
    assert [mode.contacts for mode in both.modes] == [{"skin": "sticking"}, {}]
    assert (both.contacts, both.distinct, both.possible) == (["skin"], 2, 4)
    assert joined([None]) is None


def test_in_space_slips_are_those_of_the_contact_and_joints_have_stops() -> None:
    arm = joint("slide", "prismatic", "box", "arm", '<limit lower="0" upper="0.5" effort="9"/>')
    puck = system(
        robot(link("box", mass=2.0, com="0 0 0"), link("arm", mass=0.1, com="0 0 0"), arm),
        base="floating",
        contacts={"skin": {"link": "box", "at": [0, 0, -0.1]}},
    )
    phase = problem().model_copy(update={"system": puck})
    knots = (STEP * np.arange(4.0)).tolist()
    states: dict[str, list[float | None]] = {name: [0.0] * 4 for name in puck.coordinates}
    states |= {
        "base.z": [0.1, 0.1, 0.1, 0.2],
        "base.y": [0.0, 0.0, 0.1, 0.1],
        "base.qw": [1.0] * 4,
        "slide": [0.2, 0.2, 0.5, 0.5],
    }
    forces: dict[str, list[float | None]] = {
        "contact.skin.normal": [20.0, 20.0, 0.0],
        "contact.skin.tangential_x": [0.0] * 3,
        "contact.skin.tangential_y": [0.0, -20.0, 0.0],
        "limit.slide": [0.0, -30.0, 0.0],
    }
    groups = {
        "states": Group(time=knots, values=states),
        "forces": Group(time=knots[1:], values=forces),
    }
    result = PhaseResult(name="push", knots=knots, groups=groups, curves={})
    found = contact_sequence(phase, result, {})
    assert words(found) == [
        {"skin": "sticking"},
        {"skin": "sliding", "limit.slide": "upper"},
        {},
    ]
    assert found is not None
    assert found.possible == 3 * 3
