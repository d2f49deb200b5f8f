"""What the refinement knows of one phase."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.mesh import Mesh

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Meshed:
    """The mesh of a phase, and what solving on it told.

    Attributes
    ----------
    mesh
        Has ``degrees`` where the method works by degree.
    errors
        The relative error of each segment (segments,); NaN counts as the largest.
    order
        The error of a segment falls as its length to this power. Of a method by degree it is
        one more than the segment's own degree, and this number is not used.
    seams
        How far neighbours are from one polynomial (segments - 1,), as ``curves.seams`` gives it.
        Without it nothing is joined.
    rates
        How fast the states' coefficients fall on each segment (segments,), as ``curves.decay``
        gives it. Needed for a method by degree alone.
    before
        The mesh before this one. What was cut or raised since then is not undone.
    least
        The parts of each segment at the least, whatever its error, (segments,).
    shares
        The error of the integrals on each segment over what it may have, (segments,).
    """

    mesh: Mesh
    errors: Array
    order: int
    seams: Array | None = None
    rates: Array | None = None
    before: Mesh | None = None
    least: NDArray[np.int_] | None = None
    shares: Array | None = None

    @property
    def orders(self) -> NDArray[np.int_]:
        """The order of each segment's error, (segments,)."""
        degrees = self.mesh.degrees
        return np.full(self.mesh.segments, self.order) if degrees is None else degrees + 1

    def fresh_knots(self) -> Flags:
        """Which of the inner knots the mesh before did not have, (segments - 1,)."""
        inner = self.mesh.knots[1:-1]
        if self.before is None:
            return np.zeros(len(inner), dtype=bool)
        return np.asarray(_distances(inner, self.before.knots) > _SAME)

    def fresh(self) -> Flags:
        """Which segments were cut out of a longer one, or raised in degree, (segments,)."""
        if self.before is None:
            return np.zeros(self.mesh.segments, dtype=bool)
        at_knot = np.concatenate([[False], self.fresh_knots(), [False]])
        cut = at_knot[:-1] | at_knot[1:]
        if self.mesh.degrees is None or self.before.degrees is None:
            return np.asarray(cut)
        middles = (self.mesh.knots[:-1] + self.mesh.knots[1:]) / 2
        held = np.searchsorted(self.before.knots, middles) - 1
        return np.asarray(cut | (self.mesh.degrees > self.before.degrees[held]))


_SAME = 1e-12  # of the phase


def _distances(points: Array, knots: Array) -> Array:
    return np.asarray(np.abs(points[:, None] - knots[None, :]).min(axis=1))
