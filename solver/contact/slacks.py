"""The slacks of a guessed contact, from what it does: its gap, its slip, its forces."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.contact.names import ContactNames, SpaceNames
from solver.contact.space import around
from solver.numeric.tape import Array


@dataclass(frozen=True, slots=True)
class Guessed:
    """One contact at some times: gap, m, and normal force, N, (k,); slips, m/s, and friction, N.

    The last two have a row for each tangent, (tangents, k): one in the plane, two in space.
    """

    gap: Array
    normal: Array
    slips: Array
    friction: Array

    def planar(self, pair: str) -> dict[str, Array]:
        """The variables of a pair in the plane."""
        names, slip, push = ContactNames(pair), self.slips[0], self.friction[0]
        return {
            names.normal: self.normal,
            names.right: np.maximum(push, 0.0),
            names.left: np.maximum(-push, 0.0),
            names.slip: slip,
            names.gap: np.maximum(self.gap, 0.0),
            names.speed: np.abs(slip),
            names.ahead: np.abs(slip) + slip,
            names.behind: np.abs(slip) - slip,
            names.spare: np.maximum(self.normal - np.abs(push), 0.0),
        }

    def spatial(self, contact: str, controls: Sequence[str]) -> dict[str, Array]:
        """The variables of a contact in space, with as many directions as ``controls`` have.

        Of evenly spread unit vectors d the sum of ``max(f d, 0) d`` is ``f`` times a quarter of
        their number, so four of them share every force ``f`` exactly.
        """
        names = SpaceNames(contact)
        pushes = names.pushes(controls)
        directions = np.array(around(len(pushes)))
        along = directions @ self.slips
        speed = np.max(-along, axis=0, initial=0.0)
        shares = np.maximum(directions @ self.friction, 0.0) * 4 / max(len(pushes), 1)
        return {
            names.normal: self.normal,
            names.gap: np.maximum(self.gap, 0.0),
            names.speed: speed,
            names.spare: np.maximum(self.normal - shares.sum(axis=0), 0.0),
            **dict(zip(names.slips, self.slips, strict=True)),
            **dict(zip(pushes, shares, strict=True)),
            **{names.ahead(k): speed + one for k, one in enumerate(along)},
        }
