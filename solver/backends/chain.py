"""A program in stage order: what a solver wants that factorises stage by stage.

The variables are sorted by time into nodes. A node that no row and no second derivative reaches
across is a knot, and begins a stage. Stage k owns states X_k (what its knot shares with the stage
before) and inputs U_k (what lies between the knots, and a copy of X_(k+1), by which implicit rows
such as those of collocation become constraints of one stage). The gap rows X_(k+1) - copy = 0 are
linear: once met they hold at every iterate, so the program's own functions may be read at X alone.

What is used in stages far apart (free times, parameters, one end of a constraint over both) is
carried along as a constant state.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int_]
Mask = NDArray[np.bool_]

_NEAR = 24  # nodes that a row of one segment may leap over; what leaps further couples the ends
_FEWEST = 3  # stages, below which nothing is gained
_WIDEST = 150  # variables of a stage, above which its dense factors cost more than they save


class NoChain(ValueError):
    """The program has no stage order; the message says why."""


class Pattern(NamedTuple):
    """Which variables meet: entries (row, column) of the Jacobian, (one, other) of the Hessian."""

    rows: Indices
    columns: Indices
    ones: Indices
    others: Indices


@dataclass(frozen=True, slots=True)
class Chain:
    """The stage order. Stages are numbered 0 to the last; sizes have shape (stages,).

    Attributes
    ----------
    states, inputs, constraints
        Sizes of each stage; ``constraints`` without its gap rows.
    source
        The program's variable behind each variable of the chain, shape (variables,).
    primary
        Where each variable of the program is read and bounded, shape (n,).
    order
        The program's row behind each row of the chain; -1 for a gap row.
    gaps
        Row, next state and its copy, of each gap row, shape (3, gaps).
    jacobian
        Row and column of each entry of the program's Jacobian, shape (2, entries); row -1 where
        it has no limits and is left out.
    hessian
        Both columns of each entry of the program's Hessian, shape (2, entries).
    """

    states: Indices
    inputs: Indices
    constraints: Indices
    source: Indices
    primary: Indices
    order: Indices
    gaps: Indices
    jacobian: Indices
    hessian: Indices


def find_chain(nodes: Indices, pattern: Pattern, kept: Mask) -> Chain:
    """Bring a program into stage order.

    ``nodes`` (n,) are its variables' places in time (``Program.nodes``), ``kept`` (m,) the rows
    that have limits.

    Raises
    ------
    NoChain
        Where it has no such order, or none worth having.
    """
    uses = _Uses.of(pattern, kept)
    nodes = uses.without_far(nodes)
    first, last = uses.spans(nodes)
    knots = _knots(nodes, first, last)
    if len(knots) <= _FEWEST:
        raise NoChain(_reason(nodes, first, last, kept))
    # The stage of a variable (-1: of all), and of a row or second derivative.
    stage = np.where(nodes < 0, -1, np.searchsorted(knots, nodes, side="right") - 1)
    home = np.maximum(np.searchsorted(knots, first, side="right") - 1, 0)
    table = _Columns.of(stage, uses.carried(stage, home), len(knots))
    return _ordered(table, pattern, kept, home)


class _Uses(NamedTuple):
    """Which variable is used in which line: rows that have limits, then the Hessian's entries."""

    lines: Indices
    variables: Indices
    lines_in_all: int

    @classmethod
    def of(cls, pattern: Pattern, kept: Mask) -> "_Uses":
        used, pairs = kept[pattern.rows], len(kept) + np.arange(len(pattern.ones))
        return cls(
            np.concatenate([pattern.rows[used], pairs, pairs]),
            np.concatenate([pattern.columns[used], pattern.ones, pattern.others]),
            len(kept) + len(pairs),
        )

    def without_far(self, nodes: Indices) -> Indices:
        """Take out of time what meets variables much later: it is carried along instead."""
        nodes, near = nodes.copy(), min(_NEAR, (int(nodes.max(initial=0)) + 1) // 2)
        order = np.lexsort((nodes[self.variables], self.lines))
        lines, variables = self.lines[order], self.variables[order]
        where = nodes[variables]
        leaps = (np.diff(lines) == 0) & (np.diff(where) > near) & (where[:-1] >= 0)
        last_before = np.full(self.lines_in_all, -1)
        last_before[lines[:-1][leaps]] = np.flatnonzero(leaps)
        before = np.arange(len(lines)) <= last_before[lines]
        nodes[variables[before]] = -1
        timed = nodes >= 0
        nodes[timed] = np.unique(nodes[timed], return_inverse=True)[1]
        return nodes

    def spans(self, nodes: Indices) -> tuple[Indices, Indices]:
        """First and last node of each line; -1 where it has none."""
        where = nodes[self.variables]
        timed = where >= 0
        first, last = (
            np.full(self.lines_in_all, np.iinfo(np.int64).max),
            np.full(self.lines_in_all, -1),
        )
        np.minimum.at(first, self.lines[timed], where[timed])
        np.maximum.at(last, self.lines[timed], where[timed])
        return np.where(last < 0, -1, first), last

    def carried(self, stage: Indices, home: Indices) -> Mask:
        """Variables that a line of the stage before their own uses."""
        reached = np.zeros(len(stage), dtype=bool)
        reached[self.variables[home[self.lines] < stage[self.variables]]] = True
        return reached


def _knots(nodes: Indices, first: Indices, last: Indices) -> Indices:
    """Nodes that nothing reaches across; the first and the last always are."""
    count = int(nodes.max(initial=-1)) + 1
    change, wide = np.zeros(count + 1, dtype=int), last - first > 1
    np.add.at(change, first[wide] + 1, 1)
    np.add.at(change, last[wide], -1)
    return np.flatnonzero(np.cumsum(change)[:count] == 0)


def _reason(nodes: Indices, first: Indices, last: Indices, kept: Mask) -> str:
    end = int(nodes.max(initial=-1))
    whole = kept & (last - first >= end)[: len(kept)]
    if end >= _FEWEST and 0 < int(whole.sum()) < int(kept.sum()) // 4:
        return "an integral in a constraint, or not linear in the objective, joins all stages"
    return f"it has fewer than {_FEWEST} segments"


class _Columns(NamedTuple):
    """The chain's variables, numbered: in each stage shared ones, states, inputs, copies."""

    stages: Indices
    source: Indices
    states: Indices
    inputs: Indices
    stage: Indices
    primary: Indices
    copy: Indices
    rank: Indices
    begins: Indices

    @classmethod
    def of(cls, stage: Indices, carried: Mask, count: int) -> "_Columns":
        shared, states = np.flatnonzero(stage < 0), np.flatnonzero((stage >= 0) & carried)
        inputs = np.flatnonzero((stage >= 0) & ~carried)
        parts = [np.tile(shared, count), states, inputs, states]
        sizes = [len(part) for part in parts]
        source, kinds = np.concatenate(parts), np.repeat([0, 1, 2, 3], sizes)
        stages = np.concatenate(
            [
                np.repeat(np.arange(count), len(shared)),
                stage[states],
                stage[inputs],
                stage[states] - 1,
            ]
        )
        order = np.lexsort((source, kinds, stages))
        place = np.empty(len(order), dtype=int)
        place[order] = np.arange(len(order))
        everywhere, own, free, copies = np.split(place, np.cumsum(sizes)[:-1])
        table = np.bincount(stages * 4 + kinds, minlength=4 * count).reshape(-1, 4)
        if int(table.sum(axis=1).max()) > _WIDEST:
            raise NoChain(f"a stage would have more than {_WIDEST} variables")
        primary, copy, rank = (np.full(len(stage), -1) for _ in range(3))
        primary[shared], primary[states], primary[inputs] = everywhere[: len(shared)], own, free
        copy[states], rank[shared] = copies, np.arange(len(shared))
        return cls(
            stages=stages[order],
            source=source[order],
            states=table[:, 0] + table[:, 1],
            inputs=table[:, 2] + table[:, 3],
            stage=stage,
            primary=primary,
            copy=copy,
            rank=rank,
            begins=np.concatenate([[0], np.cumsum(table.sum(axis=1))[:-1]]),
        )

    def at(self, home: Indices, variables: Indices) -> Indices:
        """The columns that stand for some variables in the stages ``home``."""
        own = np.where(self.stage[variables] == home, self.primary[variables], self.copy[variables])
        shared = self.begins[home] + self.rank[variables]
        return np.where(self.stage[variables] < 0, shared, own)

    def gaps(self) -> tuple[Indices, Indices, Indices]:
        """Stage, next state and its counterpart in the stage, of all gap rows."""
        offset = np.arange(len(self.source)) - self.begins[self.stages]
        following = np.flatnonzero((offset < self.states[self.stages]) & (self.stages > 0))
        before = self.stages[following] - 1
        return before, following, self.at(before, self.source[following])


def _ordered(table: _Columns, pattern: Pattern, kept: Mask, home: Indices) -> Chain:
    """The rows in stage order, each stage's gap rows first, and where all entries belong."""
    rows = np.flatnonzero(kept)
    before, following, counterpart = table.gaps()
    stages = np.concatenate([before, home[rows]])
    kinds = np.repeat([0, 1], [len(before), len(rows)])
    source = np.concatenate([np.full(len(before), -1), rows])
    order = np.lexsort((np.arange(len(stages)), kinds, stages))
    place = np.empty(len(order), dtype=int)
    place[order] = np.arange(len(order))
    row_place = np.full(len(kept), -1)
    row_place[rows] = place[len(before) :]
    of_row, of_pair = home[pattern.rows], home[len(kept) :]
    return Chain(
        states=table.states,
        inputs=table.inputs,
        constraints=np.bincount(home[rows], minlength=len(table.states)),
        source=table.source,
        primary=table.primary,
        order=source[order],
        gaps=np.stack([place[: len(before)], following, counterpart]),
        jacobian=np.stack([row_place[pattern.rows], table.at(of_row, pattern.columns)]),
        hessian=np.stack([table.at(of_pair, pattern.ones), table.at(of_pair, pattern.others)]),
    )
