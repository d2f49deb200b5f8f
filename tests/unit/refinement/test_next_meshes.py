"""The next mesh: cut, joined, raised, and never beyond its caps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.problem import Refinement
from solver.mesh import Mesh
from solver.refinement.meshed import Meshed
from solver.refinement.refine import next_meshes

SETTINGS = Refinement(tolerance=1e-6)
ALONE = Refinement(tolerance=1e-6, merge=False)


def meshed(errors: list[float], **changes: object) -> Meshed:
    """Equal segments of a method of order 4, whose controls are one polynomial."""
    mesh = Mesh.uniform(len(errors))
    given: dict[str, object] = {"seams": np.zeros(len(errors) - 1), "order": 4} | changes
    return Meshed(mesh=mesh, errors=np.array(errors), **given)  # type: ignore[arg-type]


def only(phase: Meshed, settings: Refinement = SETTINGS) -> Mesh:
    """The next mesh of a single phase, which must have one."""
    (mesh,) = next_meshes([phase], settings) or []
    return mesh


def test_only_segments_above_the_tolerance_are_cut() -> None:
    mesh = only(meshed([1e-7, 1e-5, 1e-6]))
    np.testing.assert_allclose(mesh.knots, [0, *np.linspace(1 / 3, 2 / 3, 5), 1])


@pytest.mark.parametrize(("error", "parts"), [(1.1e-6, 2), (1e-5, 4), (1.0, 5), (np.nan, 5)])
def test_the_count_of_8_22(error: float, parts: int) -> None:
    assert only(meshed([error])).segments == parts


def test_parts_that_are_asked_for_are_made_whatever_the_error() -> None:
    mesh = only(meshed([1e-7, 1e-7, 1e-5], least=np.array([1, 3, 2])))
    np.testing.assert_allclose(mesh.knots * 12, [0, 4, 4 + 4 / 3, 4 + 8 / 3, 8, 9, 10, 11, 12])
    assert next_meshes([meshed([1e-7] * 3, least=np.ones(3, dtype=int))], ALONE) is None


def test_little_room_goes_to_the_worst() -> None:
    mesh = only(meshed([1, 3, 2, 1.0]), Refinement(max_segments=5))
    np.testing.assert_allclose(mesh.knots, [0, 0.25, 0.375, 0.5, 0.75, 1])


def test_neighbours_far_below_the_tolerance_are_joined() -> None:
    mesh = only(meshed([1e-9, 1e-9, 1e-9, 1e-5, 1e-7, 1e-7]))
    np.testing.assert_allclose(mesh.knots * 6, [0, 2, 3, 3.25, 3.5, 3.75, 4, 5, 6])


def test_joining_is_off_where_asked() -> None:
    assert only(meshed([1e-9] * 5 + [1e-5]), ALONE).segments == 5 + 4


@pytest.mark.parametrize(("error", "joined"), [(6.2e-9, True), (6.3e-9, False)])
def test_the_joined_error_is_the_error_times_two_to_the_order(error: float, joined: bool) -> None:
    mesh = only(meshed([error, error, 1e-7, 1e-7, 1e-7, 1e-7, 1.0]))
    assert (mesh.knots[1] > 0.2) == joined


def test_segments_of_different_lengths() -> None:
    knots = np.array([0, 0.01, 0.2, 0.4, 0.6, 0.8, 1.0])
    phase = Meshed(Mesh(knots), np.array([1e-12, 1e-9, 1, 1, 1, 1]), 4, np.zeros(5))
    assert only(phase).knots[1] == 0.01, "its error would grow by 20^4"
    longer = Meshed(Mesh(knots), np.array([1e-14, 1e-9, 1, 1, 1, 1]), 4, np.zeros(5))
    assert only(longer).knots[1] == 0.2


def test_what_was_just_cut_is_not_joined_again() -> None:
    before = Mesh.uniform(6)
    parts = np.array([1, 1, 1, 1, 1, 2])
    phase = Meshed(before.subdivide(parts), np.full(7, 1e-12), 4, np.zeros(6), before=before)
    worse = Meshed(phase.mesh, np.array([1e-5, *[1e-12] * 6]), 4, np.zeros(6), before=before)
    knots = only(worse).knots
    assert np.isclose(knots, 11 / 12).any()
    assert only(Meshed(worse.mesh, worse.errors, 4, worse.seams)).segments < len(knots) - 1


def test_a_control_that_bends_keeps_its_knot() -> None:
    seams = np.array([0.0, 0.5, 0.0, 0.0, 0.0])
    mesh = only(meshed([*[1e-10] * 4, 1e-9, 1.0], seams=seams))
    np.testing.assert_allclose(mesh.knots[:4] * 6, [0, 2, 4, 5])


@pytest.mark.parametrize(("share", "joined"), [(0.024, True), (0.026, False)])
def test_what_the_integrals_need_is_not_joined(share: float, joined: bool) -> None:
    """A segment twice as long has eight times the share, and twice of what it may have."""
    phase = meshed([*[1e-12] * 6, 1.0], shares=np.array([share] * 6 + [0.0]))
    assert (only(phase).segments < 6 + 5) == joined


def test_a_phase_keeps_a_few_segments() -> None:
    small, large = meshed([1e-12] * 5), meshed([1.0])
    first, _ = next_meshes([small, large], SETTINGS) or []
    assert first.segments == 4


def test_within_the_tolerance_there_is_no_next_mesh() -> None:
    assert next_meshes([meshed([1e-7] * 6)], SETTINGS) is None


def test_no_time_and_no_room() -> None:
    phase = meshed([1.0] * 6)
    assert next_meshes([phase], Refinement(seconds=2.0), 2.0) is None
    assert next_meshes([phase], Refinement(seconds=2.0), 1.9) is not None
    assert next_meshes([phase], Refinement(max_segments=6)) is None


def test_joins_make_room() -> None:
    settings = Refinement(max_segments=6)
    mesh = only(meshed([1e-9, 1e-9, 1e-7, 1e-7, 1.0, 1e-7]), settings)
    np.testing.assert_allclose(mesh.knots * 6, [0, 2, 3, 4, 4.5, 5, 6])


def hp_phase(errors: list[float], rates: list[float], points: list[int]) -> Meshed:
    """Equal segments with degrees of their own."""
    mesh = Mesh(np.linspace(0, 1, len(errors) + 1), np.array(points))
    return Meshed(mesh, np.array(errors), 0, np.zeros(len(errors) - 1), np.array(rates))


def test_smooth_segments_rise_and_rough_ones_are_cut() -> None:
    mesh = only(hp_phase([1e-4, 1e-4], [2.0, 0.3], [5, 5]))
    # log(1e-4 / 1e-7) / 2 = 3.45, and (1e3)^(1/6) = 3.16
    assert mesh.degrees is not None
    assert mesh.degrees.tolist() == [9, 4, 4, 4, 4]
    np.testing.assert_allclose(mesh.knots, [0, *np.linspace(0.5, 1, 5)])


def test_above_the_most_points_a_smooth_segment_is_cut() -> None:
    mesh = only(
        hp_phase(
            [1e-4],
            [
                1.2,
            ],
            [9],
        )
    )
    assert mesh.degrees is not None
    assert mesh.degrees.tolist() == [9, 9]


def test_segments_too_accurate_lose_points() -> None:
    errors = [1e-4, 1e-11, 1e-9, 1e-30]
    mesh = only(hp_phase(errors, [2.0, 2.0, 2.0, np.inf], [6, 8, 8, 8]))
    # log(1e-7 / 1e-11) / 2 = 4.6 and log(1e-7 / 1e-9) / 2 = 2.3; never below 3
    assert mesh.degrees is not None
    assert mesh.degrees.tolist() == [10, 4, 6, 3]
    kept = next_meshes([hp_phase(errors, [2.0] * 4, [6, 8, 8, 8])], ALONE) or []
    assert kept[0].degrees is not None
    assert kept[0].degrees.tolist() == [10, 8, 8, 8]


def test_what_was_just_raised_is_not_lowered() -> None:
    before = Mesh(np.array([0, 0.5, 1]), np.array([4, 6]))
    now = Mesh(before.knots, np.array([6, 6]))
    phase = Meshed(now, np.array([1e-11, 1e-4]), 0, np.zeros(1), np.full(2, 2.0), before)
    degrees = only(phase).degrees
    assert degrees is not None
    assert degrees.tolist() == [6, 10]


def test_little_room_keeps_the_points() -> None:
    phase = hp_phase([1e-3, 1e-4], [0.3, 0.3], [6, 6])
    degrees = only(phase, Refinement(max_segments=3)).degrees
    assert degrees is not None
    assert degrees.tolist() == [4, 4, 6]


@settings(deadline=None)
@given(
    st.lists(st.floats(0, 1e3) | st.just(np.nan), min_size=1, max_size=40),
    st.integers(0, 60),
    st.booleans(),
    st.data(),
)
def test_next_meshes_are_meshes(
    errors: list[float], room: int, by_degree: bool, data: st.DataObject
) -> None:
    settings = Refinement(max_segments=len(errors) + room)
    size = len(errors)
    points = np.array(data.draw(st.lists(st.integers(1, 20), min_size=size, max_size=size)))
    rates = np.array(data.draw(st.lists(st.floats(-1, 20), min_size=size, max_size=size)))
    mesh = Mesh(np.linspace(0, 1, size + 1), points if by_degree else None)
    phase = Meshed(mesh, np.array(errors), 3, np.zeros(size - 1), rates)
    after = next_meshes([phase], settings)
    if after is None:
        assert room == 0 or not np.any(~(np.array(errors) <= settings.tolerance))
        return
    (refined,) = after
    assert np.all(np.diff(refined.knots) > 0)
    assert refined.segments <= settings.max_segments
    assert (refined.degrees is None) == (not by_degree)
    if refined.degrees is not None:
        assert len(refined.degrees) == refined.segments
        assert np.all(refined.degrees >= min(3, points.min()))
        assert np.all(refined.degrees <= max(settings.max_points, points.max()))
