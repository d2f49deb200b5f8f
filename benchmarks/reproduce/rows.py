"""What a reproduction table is made of: rows as data, and what was measured for each."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Patch = Mapping[str, Any]

FINE: Patch = {"tolerance": 1e-8, "max_iterations": 10, "max_segments": 1000, "seconds": 20}
"""The refinement that a row's second solve uses, unless it has one of its own."""


@dataclass(frozen=True)
class Row:
    """One case of a table.

    Attributes
    ----------
    name
        What the row is called; unique in its table.
    example
        The problem in the gallery.
    changes
        Fields of the problem that differ: its method on the table's mesh, its guess.
    printed, printed_seconds
        What the seed prints, in its own digits; empty where it prints nothing.
    optimum
        J*, the continuous optimum, where it is known.
    tolerance
        How far the refined objective may be from it, relative to the larger of 1 and J*.
    refinement
        The second solve's refinement; None where one mesh is all there is to the row.
    refined
        Fields of the problem that differ in the second solve, beside the refinement.
    meets
        False where this method is not expected to reach the optimum; ``why`` then says why.
    why
        Why printed value and ours differ, where they do.
    kind
        How the row is measured: a solve, the example as it is with its audit, whole runs from
        random guesses, or the seed's sums.
    """

    name: str
    example: str
    changes: Patch = field(default_factory=dict)
    printed: str = ""
    printed_seconds: str = ""
    optimum: float | None = None
    tolerance: float = 1e-6
    refinement: Patch | None = field(default_factory=lambda: FINE)
    refined: Patch = field(default_factory=dict)
    meets: bool = True
    why: str = ""
    kind: Literal["solve", "audit", "random", "sums"] = "solve"


@dataclass(frozen=True)
class Table:
    """A section of a seed: its number, its title, what is compared, and the rows."""

    section: str
    title: str
    about: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Measured:
    """What was found for a row.

    ``objective``, ``error`` and ``seconds`` belong to the table's mesh of ``segments`` segments,
    ``refined`` and ``refined_segments`` to the second solve. ``note`` is a remark of the measure.
    """

    status: str
    objective: float | None
    error: float | None
    segments: int
    seconds: float
    refined: float | None = None
    refined_segments: int | None = None
    note: str = ""


@dataclass(frozen=True)
class Verdict:
    """Whether a row came out as it should, and in words why not."""

    passed: bool
    words: str
