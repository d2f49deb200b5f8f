"""Contacts that hold what others hold already: found in numbers, at a place taken by chance."""

import random
from collections.abc import Mapping, Sequence

import numpy as np

from schemas.expressions import Name, Tree, derivative, fold
from schemas.expressions.constant import FLOATS
from solver.mechanics.spatial_contacts import SpatialHeld

_NOTHING = 1e-9
"""What is left of a unit row, when others are taken off, that counts as nothing."""


def dependent(
    coordinates: Sequence[str], held: Sequence[SpatialHeld], trees: Mapping[str, Tree]
) -> tuple[str, ...]:
    """Labels of rows whose rates depend on those before them, whatever the forces.

    Rates are linear in velocities, so one velocity after the other gives the Jacobian; what is
    dependent at a place by chance is so everywhere.
    """
    chance = random.Random(0)  # noqa: S311  no secret
    place = {name: chance.uniform(-1.0, 1.0) for name in coordinates}
    columns = []
    for moving in coordinates:
        rates = {derivative(name): float(name == moving) for name in coordinates}
        known = _Values(trees, {**place, **rates})
        columns.append([known[one.rate] for one in held])
    basis: list[np.ndarray] = []
    found = []
    for one, row in zip(held, np.array(columns).T, strict=True):
        left = row / (np.linalg.norm(row) or 1.0)
        for _ in range(2):  # twice is enough: Gram and Schmidt lose digits
            for other in basis:
                left = left - (left @ other) * other
        size = np.linalg.norm(left)
        if size <= _NOTHING:
            found.append(one.label)
        else:
            basis.append(left / size)
    return tuple(found)


class _Values(dict[str, float]):
    """Numbers of names, worked out when first asked for."""

    def __init__(self, trees: Mapping[str, Tree], known: Mapping[str, float]) -> None:
        super().__init__(known)
        self._trees = trees

    def __missing__(self, name: str) -> float:
        self[name] = fold(self._trees[name], FLOATS, self._named)
        return self[name]

    def _named(self, name: Name) -> float:
        return self[name.name]
