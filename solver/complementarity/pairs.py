"""Pairs where they stand in a scaled program: columns, rows, and what is left of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from solver.complementarity.pair import Pair
from solver.complementarity.relaxations import RELAXATION, SUMMED_LABEL
from solver.nlp.program import Program
from solver.nlp.scaling import Scaling

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Columns = Mapping[tuple[int | None, str], Mapping[float, int]]

_DIGITS = 10  # of a fraction: shorter segments do not occur


class Place(NamedTuple):
    """One pair at one step: its label, its phase and where in it the step ends."""

    label: str
    phase: int
    fraction: float


@dataclass(frozen=True, slots=True)
class Pairing:
    """The pairs of a scaled program, one for each pair and step, k in all.

    Attributes
    ----------
    members
        The columns of both members, (k, 2).
    sizes
        What a scaled variable times this is in the pair's own sizes, (k, 2).
    rows
        The row that relaxes each, (k,); with summed rows the same for all pairs of a step.
    column, scale
        The column of the relaxation, and what it was divided by.
    places
        What each is called.
    fixed
        The scaled value of each variable that the program fixes, NaN for others, (n,). A task may
        have opened some of them, which others imply.
    """

    members: Indices
    sizes: Array
    rows: Indices
    column: int
    scale: float
    places: tuple[Place, ...]
    fixed: Array

    @classmethod
    def of(
        cls,
        program: Program,
        scaling: Scaling,
        pairs: Sequence[Pair],
        relaxation_name: str = RELAXATION,
    ) -> Self:
        """Find the pairs in a program: wherever both members are variables.

        Raises
        ------
        KeyError
            If a member, the relaxation or a pair's row is not there.
        """
        columns, rows = _columns(program), _rows(program)
        (column,) = columns[None, relaxation_name].values()
        members, sizes, places = list[tuple[int, int]](), list[Array](), list[Place]()
        for pair in pairs:
            first, second = columns[pair.phase, pair.first], columns[pair.phase, pair.second]
            for fraction in sorted(first.keys() & second.keys()):
                members.append((first[fraction], second[fraction]))
                sizes.append(scaling.columns[[*members[-1]]] / pair.sizes)
                places.append(Place(pair.label, pair.phase, fraction))
        return cls(
            np.array(members, dtype=int).reshape(-1, 2),
            np.array(sizes).reshape(-1, 2),
            np.array([_row(rows, place) for place in places], dtype=int),
            column,
            float(scaling.columns[column]),
            tuple(places),
            _fixed(program) / scaling.columns,
        )

    @property
    def first(self) -> Indices:
        """The columns of the first members, (k,)."""
        return self.members[:, 0]

    @property
    def second(self) -> Indices:
        """The columns of the second members, (k,)."""
        return self.members[:, 1]

    def values(self, z: Array) -> Array:
        """Both members over their sizes at a scaled point (n,), shape (k, 2)."""
        values: Array = z[self.members] * self.sizes
        return values

    def residuals(self, z: Array) -> tuple[float, float]:
        """The largest smaller member of a pair, and the largest product, both over the sizes."""
        values = self.values(z)
        smaller = np.abs(values).min(axis=1).max(initial=0.0)
        return float(smaller), float(np.abs(values.prod(axis=1)).max(initial=0.0))


def paired_scaling(program: Program, scaling: Scaling, pairs: Sequence[Pair]) -> Scaling:
    """The scaling with the members of pairs divided by their sizes in them.

    A guess says nothing of these: the gaps of feet on the ground are round-off, and forces zero.
    """
    sizes: dict[tuple[int | None, str], float] = {
        (pair.phase, name): size
        for pair in pairs
        for name, size in zip((pair.first, pair.second), pair.sizes, strict=True)
    }
    columns = scaling.columns.copy()
    for block in program.variables.blocks:
        for name, indices in zip(block.names, block.indices, strict=True):
            if (block.phase, name) in sizes:
                columns[indices] = sizes[block.phase, name]
    return replace(scaling, columns=columns)


def unpaired(program: Program, pairs: Sequence[Pair]) -> Program:
    """The program with its pair rows open: what it says of all else, whatever the relaxation."""
    labels = {
        (pair.phase, f"path {label}") for pair in pairs for label in (pair.label, SUMMED_LABEL)
    }
    groups = []
    for group in program.groups:
        ours = np.array([(group.phase, name) in labels for name in group.rows.names], dtype=bool)
        rows = replace(
            group.rows,
            lower=np.where(ours, -np.inf, group.rows.lower),
            upper=np.where(ours, np.inf, group.rows.upper),
        )
        groups.append(replace(group, rows=rows))
    return replace(program, groups=tuple(groups))


def _fixed(program: Program) -> Array:
    lower, upper = program.variables.gather("lower"), program.variables.gather("upper")
    return np.where(lower == upper, lower, np.nan)


def _columns(program: Program) -> Columns:
    """Phase and name -> fraction -> column; of names without a time NaN is the fraction."""
    columns = dict[tuple[int | None, str], dict[float, int]]()
    for block in program.variables.blocks:
        for name, indices in zip(block.names, block.indices, strict=True):
            at = columns.setdefault((block.phase, name), {})
            at |= zip(block.fractions.round(_DIGITS).tolist(), indices.tolist(), strict=True)
    return columns


def _rows(program: Program) -> Mapping[Place, int]:
    return {
        Place(label.name, label.phase, round(label.fraction, _DIGITS)): row
        for row, label in enumerate(program.labels())
        if label.phase is not None
    }


def _row(rows: Mapping[Place, int], place: Place) -> int:
    """The row of a pair, or else of its step."""
    own, summed = (place._replace(label=f"path {label}") for label in (place.label, SUMMED_LABEL))
    return rows[own] if own in rows else rows[summed]
