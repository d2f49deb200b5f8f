"""What contacts ask for at the ends of phases, and what they do not."""

from typing import Any

from schemas.reading import read_problem
from solver.hybrid import expand
from solver.model import Phase, build_model
from tests.unit.hybrid.documents import pendulum, slider

STAND = {"name": "stand", "contacts": {"foot": "sticking"}}
SLIDE = {"name": "slide", "contacts": {"foot": "sliding_right"}}
FLY = {"name": "fly"}


def phases(document: dict[str, Any]) -> tuple[Phase, ...]:
    return build_model(expand(read_problem(document)).problem).phases


def starts(phase: Phase) -> set[str]:
    """What is asked for at a start because of contacts."""
    labels = (row.label for row in phase.boundary)
    return {label.removeprefix("start ") for label in labels if label.startswith("start ")}


def test_a_first_phase_is_asked_for_places_and_rates() -> None:
    (only,) = phases(slider([STAND]))
    assert starts(only) == {"contact.foot.gap", "contact.foot.d(gap)", "contact.foot.slip"}


def test_what_goes_on_is_not_asked_for_again() -> None:
    _, second = phases(slider([STAND, SLIDE]))
    assert starts(second) == set()


def test_what_stops_sliding_is_at_rest() -> None:
    _, second = phases(slider([SLIDE, STAND]))
    assert starts(second) == {"contact.foot.slip"}


def test_what_lands_is_asked_for_all() -> None:
    *_, last = phases(slider([STAND, FLY, STAND | {"name": "land"}]))
    assert starts(last) == {"contact.foot.gap", "contact.foot.d(gap)", "contact.foot.slip"}


def test_a_gap_has_no_inside_where_a_foot_leaves_or_lands() -> None:
    _, flight, _ = phases(slider([STAND, FLY, STAND | {"name": "land"}]))
    assert flight.settled == {"path foot stays open": {0.0, 1.0}}


def test_a_gap_that_is_held_is_no_path_constraint() -> None:
    path = [{"name": "above", "expression": "contact.foot.gap", "lower": 0}]
    stand, flight = phases(slider([STAND, FLY], path=path))
    assert "path above" not in {row.label for row in stand.path}
    assert "path above" in {row.label for row in flight.path}


def test_velocities_at_rest_need_no_row() -> None:
    rest = {"block.d(x)": 0, "block.d(y)": 0, "block.d(angle)": 0}
    (only,) = phases(slider([STAND], initial=rest, final=rest))
    assert starts(only) == {"contact.foot.gap"}
    fixed = [name for name in rest if only.final[name].fixed]
    assert len(fixed) == 1, "two rows of the contact hold at the end"


def test_a_period_is_a_passage_too() -> None:
    (only,) = phases(slider([STAND], periodic={}))
    assert starts(only) == set()


def test_a_mode_without_a_sequence() -> None:
    method = {"kind": "radau", "segments": 5}
    (held,) = phases(pendulum(pinned=False, method=method))
    assert starts(held) == {"contact.pin.gap", "contact.pin.d(gap)", "contact.pin.slip"}
