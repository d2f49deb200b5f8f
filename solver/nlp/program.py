"""The program: variables, stage groups and sums. In SI units; scaling happens in assembly.

minimize sum_0(w)  subject to  lower <= rows(w) <= upper,  sum_j(w) = 0 for j >= 1
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.nlp.stages import StageGroup
from solver.nlp.variables import Variables

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

_DIGITS = 10  # of a fraction: shorter segments do not occur


class RowLabel(NamedTuple):
    """What a constraint row is: its name, its phase, its place there (NaN: the ends)."""

    name: str
    phase: int | None
    fraction: float


@dataclass(frozen=True, slots=True)
class Program:
    """A nonlinear program made of stage groups.

    ``sum_names`` has name and phase of the sums from 1 on (lifted integrals); sum 0 is the
    objective.
    """

    variables: Variables
    groups: tuple[StageGroup, ...]
    sum_names: tuple[tuple[str, int], ...] = ()

    @property
    def own_rows(self) -> int:
        """Rows of all groups, without the sums."""
        return sum(len(group.rows.names) * group.stages for group in self.groups)

    @property
    def rows(self) -> int:
        """All rows: the groups', then one for each lifted integral."""
        return self.own_rows + len(self.sum_names)

    def row_vector(self, attribute: str, sums: float) -> Array:
        """An attribute of ``Rows`` for every row, ``sums`` for the rows of the sums."""
        parts = [np.tile(getattr(group.rows, attribute), group.stages) for group in self.groups]
        return np.concatenate([*parts, np.full(len(self.sum_names), sums)])

    def nodes(self) -> Indices:
        """The place of each variable in the order of time, over all phases, shape (n,).

        Equal times have equal places; -1 for what has no time.
        """
        places = np.full(self.variables.size, np.nan)
        for block in self.variables.blocks:
            if block.phase is not None:
                # Two apart, so that one phase's end and the next one's start are two places.
                places[block.indices] = 2.0 * block.phase + block.fractions
        timed, nodes = np.isfinite(places), np.full(len(places), -1)
        # Both sides of a knot compute its place; they may differ by round-off.
        nodes[timed] = np.unique(places[timed].round(_DIGITS), return_inverse=True)[1]
        return nodes

    def labels(self) -> Iterator[RowLabel]:
        """The label of every row, in order."""
        for group in self.groups:
            for stage in range(group.stages):
                for row, name in enumerate(group.rows.names):
                    yield RowLabel(name, group.phase, float(group.rows.fractions[row, stage]))
        for name, phase in self.sum_names:
            yield RowLabel(f"integral {name}", phase, float("nan"))
