"""Program -> NLP functions: per-stage derivatives, mapped and scattered by hand.

Each group's function is differentiated once, symbolically, for one stage; CasADi maps it over
the stages; constant sparse matrices add the entries up into the gradient, the Jacobian and the
Hessian of the whole. Building costs the same for any number of stages, and evaluation touches
no entry that is zero. Scaling multiplies entries by constants on the way out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from solver.nlp.kernel import Piece, kernel_of
from solver.nlp.program import Program
from solver.nlp.scaling import Scaling
from solver.nlp.stages import StageGroup

Array = NDArray[np.float64]
Indices = NDArray[np.int_]


@dataclass(frozen=True, slots=True)
class Nlp:
    """The functions of a scaled program, over z = w / scaling.columns.

    ``evaluate``: z -> (f, g); ``gradient``: z -> (f, grad f); ``jacobian``: z -> (g, J);
    ``hessian``: (z, p, sigma, lam) -> upper triangle. Rows are divided by their magnitudes.
    """

    symbols: ca.MX
    objective: ca.MX
    rows: ca.MX
    gradient: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    evaluate: ca.Function

    def derivatives(self) -> dict[str, ca.Function]:
        """The options that hand the derivatives to ``casadi.nlpsol``."""
        return {"grad_f": self.gradient, "jac_g": self.jacobian, "hess_lag": self.hessian}


class _Entries(NamedTuple):
    """Nonzeros of one group at all stages, and where in the whole they belong."""

    values: ca.MX
    rows: Indices
    columns: Indices


def assemble(program: Program, scaling: Scaling) -> Nlp:
    """Build the functions of the scaled program."""
    z, none = ca.MX.sym("z", program.variables.size), ca.MX.sym("p", 0)
    w = z * ca.DM(scaling.columns)
    stages = [_Stage(group, program, index) for index, group in enumerate(program.groups)]
    objective = ca.densify(sum((stage.cost(w) for stage in stages), start=ca.MX(0)))
    row_scale = 1.0 / scaling.rows
    rows = ca.densify(_rows(stages, w) * ca.DM(row_scale))

    size = program.variables.size
    slopes = [stage.slopes(w) for stage in stages]
    gradient = _scatter(slopes, (size, 1), scaling.columns, np.ones(1))
    entries = [stage.jacobian(w) for stage in stages]
    jacobian = _scatter(entries, (program.rows, size), row_scale, scaling.columns)

    sigma, lam = ca.MX.sym("sigma"), ca.MX.sym("lam", program.rows)
    own, lifted = ca.vertsplit(lam * ca.DM(row_scale), [0, program.own_rows, program.rows])
    sums = ca.vertcat(sigma, lifted)
    curvature = [stage.hessian(w, own, sums) for stage in stages]
    hessian = _scatter(curvature, (size, size), scaling.columns, scaling.columns)
    return Nlp(
        symbols=z,
        objective=objective,
        rows=rows,
        gradient=ca.Function("gradient", [z, none], [objective, ca.densify(gradient)]),
        jacobian=ca.Function("jacobian", [z, none], [rows, jacobian]),
        hessian=ca.Function("hessian", [z, none, sigma, lam], [hessian]),
        evaluate=ca.Function("evaluate", [z], [objective, rows]),
    )


def _rows(stages: Sequence["_Stage"], w: ca.MX) -> ca.MX:
    """All rows: the groups' own, then the lifted sums."""
    own, lifted = zip(*(stage.rows(w) for stage in stages), strict=True)
    rows: ca.MX = ca.vertcat(*own, sum(lifted[1:], start=lifted[0]))
    return rows


class _Stage:
    """One group's stage function with its derivatives, mapped over its stages."""

    def __init__(self, group: StageGroup, program: Program, index: int) -> None:
        before = program.groups[:index]
        self.first_row = sum(len(other.rows.names) * other.stages for other in before)
        self.first_sum = program.own_rows
        self.group, self.kernel = group, kernel_of(group)
        self.count = self.kernel.count

    def cost(self, w: ca.MX) -> ca.MX:
        """What the group adds to the objective."""
        return ca.sum2(self._mapped(w, self.kernel.cost()))

    def rows(self, w: ca.MX) -> tuple[ca.MX, ca.MX]:
        """The group's own rows at all stages, and what it adds to the lifted sums."""
        values = self._mapped(w, self.kernel.values())
        own, lifted = ca.vertsplit(values, [0, self.count, values.shape[0]])
        return ca.vec(own), ca.sum2(lifted)

    def slopes(self, w: ca.MX) -> _Entries:
        """Entries of the objective's gradient, as a column."""
        entries = self._first_order(w, self.kernel.slopes())
        return _Entries(entries.values, entries.columns, np.zeros_like(entries.columns))

    def jacobian(self, w: ca.MX) -> _Entries:
        """Entries of the rows' Jacobian, own rows and lifted sums."""
        entries = self._first_order(w, self.kernel.jacobian())
        stages = np.arange(self.group.stages)[None, :]
        local = entries.rows.reshape(-1, self.group.stages, order="F")
        own = self.first_row + local + self.count * stages
        rows = np.where(local < self.count, own, self.first_sum + local - self.count)
        return _Entries(entries.values, rows.flatten(order="F"), entries.columns)

    def hessian(self, w: ca.MX, multipliers: ca.MX, sum_weights: ca.MX) -> _Entries:
        """Entries of the Lagrangian's Hessian, upper triangle of the whole."""
        group, count, piece = self.group, self.count, self.kernel.hessian()
        own = multipliers[self.first_row : self.first_row + count * group.stages]
        lam = ca.reshape(own, count, group.stages)
        mu = ca.repmat(sum_weights, 1, group.stages)
        values = self._mapped(w, piece, lam, mu)
        a, b = group.columns[piece.rows], group.columns[piece.columns]
        # Two symbols may stand for one variable: their cross entry then counts on both sides.
        twice = np.where((a == b) & (piece.rows != piece.columns)[:, None], 2.0, 1.0)
        return _Entries(
            ca.vec(values * ca.DM(twice)),
            np.minimum(a, b).flatten(order="F"),
            np.maximum(a, b).flatten(order="F"),
        )

    def _first_order(self, w: ca.MX, piece: Piece) -> _Entries:
        """Derivatives of stage outputs: local rows, columns of the whole."""
        return _Entries(
            ca.vec(self._mapped(w, piece)),
            np.tile(piece.rows, self.group.stages),
            self.group.columns[piece.columns].flatten(order="F"),
        )

    def _mapped(self, w: ca.MX, piece: Piece, *weights: ca.MX) -> ca.MX:
        """Stage outputs (n,) at all stages, (n, stages); only variables that they use are read."""
        group, stages = self.group, self.group.stages
        if piece.function.numel_out(0) == 0:
            return ca.MX(0, stages)
        values = w[group.columns[piece.used].flatten(order="F").tolist()]
        inputs = (ca.reshape(values, len(piece.used), stages), ca.DM(group.data))
        mapped: ca.MX = piece.function.map(stages)(*inputs, *weights)
        return mapped


def _scatter(
    entries: Sequence[_Entries], shape: tuple[int, int], row_scale: Array, column_scale: Array
) -> ca.MX:
    """The sparse matrix with all entries added up and scaled: values times a constant matrix."""
    rows = np.concatenate([entry.rows for entry in entries])
    columns = np.concatenate([entry.columns for entry in entries])
    places, position = np.unique(columns * shape[0] + rows, return_inverse=True)
    pattern = ca.Sparsity.triplet(
        *shape, (places % shape[0]).tolist(), (places // shape[0]).tolist()
    )
    values, scale = (
        ca.vertcat(*(e.values for e in entries)),
        row_scale[rows] * column_scale[columns],
    )
    if len(places) == len(rows):  # nothing to add up: putting in order is cheaper
        order = np.argsort(position)
        return ca.MX(pattern, values[order.tolist()] * ca.DM(scale[order]))
    each = ca.Sparsity(len(places), len(rows), list(range(len(rows) + 1)), position.tolist())
    return ca.MX(pattern, ca.mtimes(ca.MX(ca.DM(each, ca.DM(scale))), values))
