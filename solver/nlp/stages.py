"""Stage groups: one function evaluated at many stages, the bricks of every program.

A group has symbols for one stage, an array that says which decision variables stand for them at
each stage, and two kinds of output: rows of its own (constraints), and contributions to sums
that run over all stages and groups (the objective, and the values of integrals).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.expressions import SX

Array = NDArray[np.float64]
Indices = NDArray[np.int_]


@dataclass(frozen=True, slots=True)
class Rows:
    """Constraint rows of a group, per stage.

    Attributes
    ----------
    expression
        Shape (rows,), symbols of one stage.
    names
        One name per row, as residuals and reports call it.
    lower, upper
        Limits, shape (rows,): the same at every stage.
    magnitude
        The size of one unit of violation, shape (rows,); rows are scaled by it.
    fractions
        Where in the phase each row lies, shape (rows, stages), NaN for its ends.
    """

    expression: SX
    names: tuple[str, ...]
    lower: Array
    upper: Array
    magnitude: Array
    fractions: Array


@dataclass(frozen=True, slots=True)
class StageGroup:
    """One function over many stages.

    Attributes
    ----------
    phase
        The phase it belongs to, None for what spans them.
    variables, constants
        Symbols of one stage, shapes (n,) and (c,).
    columns
        The decision variable behind each symbol, shape (n, stages).
    data
        The constants' values, shape (c, stages).
    rows
        The group's own constraints.
    sums
        Contributions to the program's sums, shape (sums,).
    """

    phase: int | None
    variables: SX
    constants: SX
    columns: Indices
    data: Array
    rows: Rows
    sums: SX

    def __post_init__(self) -> None:
        """Refuse symbols without a variable each: they would stand for their neighbours'."""
        given, wanted = len(self.columns), self.variables.numel()
        if given != wanted:
            raise ValueError(f"{wanted} symbols of a stage need as many variables, got {given}")

    @property
    def stages(self) -> int:
        """At how many stages the function is evaluated."""
        return int(self.columns.shape[1])
