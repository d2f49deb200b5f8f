"""Where the mesh is cut."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from schemas.problem import Refinement
from solver.mesh import Mesh
from solver.refinement.subdivide import refine

SETTINGS = Refinement(tolerance=1e-6)


def test_only_segments_above_the_tolerance_are_cut() -> None:
    (mesh,) = refine([Mesh.uniform(3)], [np.array([1e-7, 1e-5, 1e-6])], 4, SETTINGS) or []
    np.testing.assert_allclose(mesh.knots, [0, *np.linspace(1 / 3, 2 / 3, 5), 1])


@pytest.mark.parametrize(("error", "parts"), [(1.1e-6, 2), (1e-5, 4), (1.0, 5), (np.nan, 5)])
def test_the_count_of_8_22(error: float, parts: int) -> None:
    (mesh,) = refine([Mesh.uniform(1)], [np.array([error])], 4, SETTINGS) or []
    assert mesh.segments == parts


def test_no_room_is_none() -> None:
    settings = Refinement(max_segments=4)
    assert refine([Mesh.uniform(4)], [np.ones(4)], 4, settings) is None


def test_little_room_goes_to_the_worst() -> None:
    settings = Refinement(max_segments=5)
    (mesh,) = refine([Mesh.uniform(4)], [np.array([1, 3, 2, 1.0])], 4, settings) or []
    np.testing.assert_allclose(mesh.knots, [0, 0.25, 0.375, 0.5, 0.75, 1])


@given(st.lists(st.floats(0, 1e3), min_size=1, max_size=40), st.integers(1, 60))
def test_refined_meshes_are_meshes(errors: list[float], room: int) -> None:
    settings = Refinement(max_segments=len(errors) + room)
    before = Mesh.uniform(len(errors))
    (after,) = refine([before], [np.array(errors)], 2, settings) or []
    assert np.all(np.diff(after.knots) > 0)
    assert after.segments <= settings.max_segments
    assert np.isin(np.round(before.knots, 12), np.round(after.knots, 12)).all()
