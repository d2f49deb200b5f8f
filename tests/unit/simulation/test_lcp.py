"""Lemke's method: random, degenerate and unsolvable problems."""

import numpy as np
import pytest
from numpy.typing import NDArray

from solver.simulation.lcp import LcpStatus, solve_lcp

Array = NDArray[np.float64]


def violation(M: Array, q: Array, z: Array) -> float:
    return float(np.max(np.abs(np.minimum(z, M @ z + q))))


def contact_problem(rng: np.random.Generator, twins: bool) -> tuple[Array, Array]:
    """Normals and friction of some contacts of a random mechanism, as Stewart and Trinkle's."""
    n, c = int(rng.integers(3, 12)), int(rng.integers(1, 9))
    root = rng.normal(size=(n, n))
    inverse = np.linalg.inv(root @ root.T + 0.1 * np.eye(n))
    Jn, Jt = rng.normal(size=(2, c, n))
    if twins:  # toe and heel of one sole: rows repeat
        Jn[c // 2 :], Jt[c // 2 :] = Jn[: c - c // 2], Jt[: c - c // 2]
    gaps = rng.exponential(size=c) * (rng.random(c) < 0.5)
    v = 3 * rng.normal(size=n)
    if rng.random() < 0.2:
        v[:] = np.round(v)
        gaps[:] = 0
    J = np.concatenate([Jn, Jt, -Jt])
    M = np.zeros((4 * c, 4 * c))
    M[: 3 * c, : 3 * c] = J @ inverse @ J.T
    both = np.concatenate([np.eye(c), np.eye(c)])
    M[c : 3 * c, 3 * c :] = both
    M[3 * c :, : 3 * c] = np.concatenate([np.diag(rng.uniform(0, 2, c)), -both.T], axis=1)
    return M, np.concatenate([Jn @ v + gaps, Jt @ v, -Jt @ v, np.zeros(c)])


@pytest.mark.parametrize("twins", [False, True])
def test_five_hundred_contact_problems_and_not_one_failure(twins: bool) -> None:
    rng = np.random.default_rng(7)
    for _ in range(500):
        M, q = contact_problem(rng, twins)
        found = solve_lcp(M, q)
        assert found.solved, found.status
        assert violation(M, q, found.z) < 1e-8 * (1 + np.max(found.z))


def test_random_definite_problems() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        n = int(rng.integers(1, 15))
        root = rng.normal(size=(n, n))
        skew = rng.normal(size=(n, n))
        M = root @ root.T + 0.01 * np.eye(n) + skew - skew.T
        q = rng.normal(size=n) * 10.0 ** rng.integers(-6, 6)
        found = solve_lcp(M, q)
        assert found.solved
        assert violation(M, q, found.z) < 1e-9 * (np.max(np.abs(q)) + np.max(found.z))


def test_masses_from_grams_to_tons() -> None:
    scale = np.array([1e-4, 1e-2, 1.0, 1e2, 1e4])
    M = np.diag(scale) @ (np.eye(5) + 0.5) @ np.diag(scale)
    q = -scale * np.arange(1.0, 6.0)
    found = solve_lcp(M, q)
    assert found.solved
    w = (M @ found.z + q) / scale
    assert np.all(w > -1e-9)
    assert abs(float((w * scale) @ found.z)) < 1e-8


def test_nothing_to_do() -> None:
    found = solve_lcp(np.eye(2), np.array([0.0, 1.0]))
    assert found.solved
    assert found.pivots == 0
    np.testing.assert_array_equal(found.z, [0, 0])


def test_equal_ratios_do_not_cycle() -> None:
    # Every ratio of the first pivots is the same.
    for n in range(2, 12):
        M = np.ones((n, n)) + np.tril(np.ones((n, n)), -1)
        found = solve_lcp(M, -np.ones(n))
        assert found.solved
        assert violation(M, -np.ones(n), found.z) < 1e-12


def test_a_ray_is_a_value() -> None:
    # w = -z - 1 is never positive: there is no solution.
    found = solve_lcp(np.array([[-1.0]]), np.array([-1.0]))
    assert found.status is LcpStatus.RAY
    assert not found.solved


def test_a_limit_of_pivots_is_a_value() -> None:
    found = solve_lcp(np.eye(5) + 0.1, -np.arange(1.0, 6.0), limit=2)
    assert found.status is LcpStatus.PIVOT_LIMIT


def test_numbers_that_are_none() -> None:
    found = solve_lcp(np.eye(1), np.array([np.nan]))
    assert found.status is LcpStatus.INVALID_NUMBER


def test_small_pivots_are_no_pivots() -> None:
    # A stick that falls flat but for 1e-11 rad: pivots of this size once gave nonsense.
    e = 1.50145e-11
    M = np.zeros((8, 8))
    M[:2] = [[4, -2, -e, e, e, -e, 0, 0], [-2, 4, e, -e, -e, e, 0, 0]]
    M[2] = [-e, e, 1, 1, -1, -1, 1, 0]
    M[3] = [e, -e, 1, 1, -1, -1, 0, 1]
    M[4] = [e, -e, -1, -1, 1, 1, 1, 0]
    M[5] = [-e, e, -1, -1, 1, 1, 0, 1]
    M[6] = [0.3, 0, -1, 0, -1, 0, 0, 0]
    M[7] = [0, 0.3, 0, -1, 0, -1, 0, 0]
    q = np.array([0, -2.3253, -0.425, -0.425, 0.425, 0.425, 0, 0])
    found = solve_lcp(M, q)
    assert found.solved
    assert violation(M, q, found.z) < 1e-8
