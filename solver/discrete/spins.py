"""How bodies turn over a step in space, and the momentum that they have by that.

Between its rotations R0 and R1 at both ends a body turns about an axis that stands still in the
world and in the body, by ``mean(R)' (R1 - R0) = sin(a) [axis]x``, which grows to the angle. So its
spin w is that turn over the step, in its own axes. With ``D = R0' R1`` and the inertia I its
momentum changes by ``D I w1 - I w0``, seen as it stands at the start: none for a body on which
nothing acts, and since ``D w1 = w1`` the work of it is ``w1 . I (w1 - w0)``.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

from solver.discrete import differences
from solver.discrete.chord import Chord
from solver.discrete.slopes import Slopes
from solver.expressions import SX
from solver.mechanics.principle import Spin

_PLANES = ((2, 1), (0, 2), (1, 0))
"""Where a rotation about x, y and z has its sine."""


@dataclass(frozen=True, slots=True)
class Turning:
    """A body over a step: its rotation's rows, and the angle over the sine of its turn."""

    rows: Sequence[Sequence[Chord]]
    grown: SX

    @classmethod
    def of(cls, spin: Spin, slopes: Slopes) -> "Turning":
        """Work it out."""
        rows = [[slopes.of(entry) for entry in row] for row in spin.rows]
        return cls(rows, grown([entry for row in rows for entry in row]))

    @property
    def varies(self) -> bool:
        """Whether it turns at all."""
        return any(entry.varies for row in self.rows for entry in row)

    def spin(self) -> SX:
        """rad/s, (3,), in the body's axes."""
        return ca.vertcat(*(sum((f * c.rate for c, f in self._parts(k)), SX(0)) for k in range(3)))

    def pull(self, torque: SX) -> Iterator[tuple[Chord, SX]]:
        """A torque (3,) in the body's axes, as forces along what its turn is made of."""
        for k in range(3):
            for chord, factor in self._parts(k):
                yield chord, factor * torque[k]

    def carried(self, vector: SX) -> SX:
        """A vector (3,) of the body's axes at the end, in those of the start."""
        at_end = [sum((e.after * vector[j] for j, e in enumerate(row)), SX(0)) for row in self.rows]
        columns = zip(*self.rows, strict=True)
        pairs = ([*zip(column, at_end, strict=True)] for column in columns)
        return ca.vertcat(*(sum((e.before * y for e, y in pair), SX(0)) for pair in pairs))

    def _parts(self, axis: int) -> Iterator[tuple[Chord, SX]]:
        i, j = _PLANES[axis]
        for row in self.rows:
            yield row[j], 0.5 * self.grown * row[i].mean
            yield row[i], -0.5 * self.grown * row[j].mean


def grown(entries: Sequence[Chord]) -> SX:
    """The angle by which a rotation turns over its sine, by the nine entries of its matrix."""
    changes = [one.after - one.before for one in entries]
    return differences.angle_over_sine(sum((one * one for one in changes), SX(0)) / 4)


def turning(
    spin: Spin, now: Slopes, before: Slopes
) -> tuple[Iterator[tuple[Chord, SX]], SX] | None:
    """The change of a body's momentum at a step's start, as forces; and what energy that takes."""
    after, earlier = Turning.of(spin, now), Turning.of(spin, before)
    if not after.varies:
        return None
    inertia, w1, w0 = ca.DM(spin.inertia), after.spin(), earlier.spin()
    jump = w1 - w0
    change = after.carried(inertia @ w1) - inertia @ w0
    return after.pull(change), 0.5 * ca.dot(jump, inertia @ jump)
