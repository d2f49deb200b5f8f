"""Poses that meet demands: damped least squares over the coordinates, within their limits."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.numeric.tape import Array, Tape
from solver.poses.tapes import Tapes

REACHED = 1e-4
"""How far a pose may miss what is asked of it, m or rad: a solve does the rest."""

_STARTS, _STEPS, _SHARE = 40, 80, 1e-6
_NEAR, _APART = 12, 0.1
_ALIKE, _ENOUGH = 1e-4, 6
VALUELESS = 1e6
"""What a row without a value counts as missed by."""

_LEAST, _FIRST, _EASE, _BRAKE = 1e-12, 1e-3, 0.2, 8.0


class Found(NamedTuple):
    """A pose (n,), and by how much it misses what is asked of it, (rows,)."""

    pose: Array
    missed: Array

    @property
    def worst(self) -> float:
        """The largest violation."""
        return float(np.abs(self.missed).max())


@dataclass(frozen=True, slots=True)
class Search:
    """``lower <= tape <= upper``, row by row, over coordinates; limits are (rows,)."""

    tapes: Tapes
    tape: Tape
    lower: Array
    upper: Array

    def best(self, box: tuple[Array, Array], start: Array | None = None) -> Found:
        """The pose with the least violation, from some starts; the same ones every time.

        Around a given ``start`` at first, ever farther off. Where several of them end alike there
        is no better one to be expected.
        """
        lower, upper = box
        rng = np.random.default_rng(0)
        guess = np.zeros(len(lower)) if start is None else start
        found: list[Found] = []
        for number in range(_STARTS):
            found.append(self._descend(np.clip(guess, lower, upper), lower, upper))
            best = min(found, key=lambda one: one.worst)
            alike = sum(one.worst <= (1 + _ALIKE) * best.worst for one in found)
            if best.worst <= REACHED or alike >= _ENOUGH:
                break
            guess = rng.uniform(-np.pi, np.pi, len(lower))
            if start is not None and number < _NEAR:
                guess = start + _APART * (number + 1) / np.pi * guess
        return best

    def _violation(self, poses: Array) -> Array:
        """How far poses (coordinates, k) miss what is asked, signed, (rows, k)."""
        values = self.tapes.at(self.tape, poses)
        above, below = values - self.upper[:, None], values - self.lower[:, None]
        missed = np.maximum(above, 0) + np.minimum(below, 0)
        missed = np.nan_to_num(missed, nan=VALUELESS, posinf=VALUELESS, neginf=-VALUELESS)
        return np.asarray(missed, dtype=np.float64)

    def _descend(self, pose: Array, lower: Array, upper: Array) -> Found:
        """Levenberg and Marquardt's steps, kept within the box."""
        damping, missed = _FIRST, self._violation(pose[:, None])[:, 0]
        for _ in range(_STEPS):
            if np.abs(missed).max() <= _SHARE * REACHED:
                break
            slopes = self._slopes(pose)
            uphill = slopes.T @ missed
            free = ~(((pose <= lower) & (uphill > 0)) | ((pose >= upper) & (uphill < 0)))
            matrix = slopes.T @ slopes * np.outer(free, free) + damping * np.eye(len(pose))
            there = np.clip(pose - np.linalg.solve(matrix, free * uphill), lower, upper)
            after = self._violation(there[:, None])[:, 0]
            if after @ after < missed @ missed:
                pose, missed, damping = there, after, max(_EASE * damping, _LEAST)
            else:
                damping *= _BRAKE
            if damping > VALUELESS:
                break
        return Found(pose, missed)

    def _slopes(self, pose: Array) -> Array:
        """The violations' slopes, by central differences, (rows, coordinates)."""
        sizes = 1e-6 * (1 + np.abs(pose))
        shifts = np.diag(sizes)
        ahead = self._violation(pose[:, None] + shifts)
        behind = self._violation(pose[:, None] - shifts)
        return np.asarray((ahead - behind) / (2 * sizes), dtype=np.float64)
