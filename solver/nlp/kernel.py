"""The function of one stage with its derivatives: what a mesh maps over its stages.

It is known by the very nodes of CasADi's graph that it is made of. A kept kernel holds these
alive, so that no other graph can take their place in memory: equal nodes are equal functions.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from solver.expressions import SX, scalars
from solver.nlp.kept import Kept
from solver.nlp.stages import StageGroup

Indices = NDArray[np.int_]

_SHARED = 20_000
"""Instructions above which equal parts are not looked for: at 200,000 that takes a second and
saves a twentieth."""

_ROOM = 500_000  # instructions: some 100 MB


@dataclass(frozen=True, slots=True)
class Piece:
    """A stage function: of the variables ``used``, of constants and of weights.

    Attributes
    ----------
    function
        Its value is a column; of a matrix, the nonzeros.
    used
        Positions of the variables that it takes.
    rows, columns
        Of a matrix: where each nonzero belongs.
    """

    function: ca.Function
    used: Indices
    rows: Indices
    columns: Indices


@dataclass(slots=True)
class Kernel:
    """Rows (m,) and sums (s,) over variables (n,) and constants (c,) of one stage.

    Equal parts are computed once where looking for them pays: before they are differentiated, so
    that derivatives share what these share. Another search in each of them would take most of the
    time to build, for Hessians as long and Jacobians shorter by a tenth.
    """

    variables: SX
    constants: SX
    rows: SX
    sums: SX
    size: int
    sources: SX
    _pieces: dict[str, Piece] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """How many rows there are."""
        return int(self.rows.numel())

    def cost(self) -> Piece:
        """The term of the objective."""
        return self._once("cost", lambda: self._plain(self.sums[0]))

    def values(self) -> Piece:
        """The rows, then the terms of the other sums."""
        return self._once("values", lambda: self._plain(self._outputs()))

    def slopes(self) -> Piece:
        """The gradient of the term of the objective."""
        return self._once("slopes", lambda: self._first_order(self.sums[0]))

    def jacobian(self) -> Piece:
        """The derivatives of ``values``."""
        return self._once("jacobian", lambda: self._first_order(self._outputs()))

    def hessian(self) -> Piece:
        """The upper triangle of the Lagrangian's; weights are those of rows, then of sums."""
        return self._once("hessian", self._second_order)

    def _once(self, name: str, make: Callable[[], Piece]) -> Piece:
        if name not in self._pieces:
            self._pieces[name] = make()
        return self._pieces[name]

    def _outputs(self) -> SX:
        lifted = ca.vertsplit(self.sums, [0, 1, self.sums.numel()])[1]
        return ca.vertcat(self.rows, lifted)

    def _first_order(self, outputs: SX) -> Piece:
        return self._matrix(ca.jacobian(outputs, self.variables))

    def _second_order(self) -> Piece:
        lam, mu = SX.sym("lam", self.count), SX.sym("mu", self.sums.numel())
        lagrangian = ca.dot(lam, self.rows) + ca.dot(mu, self.sums)
        return self._matrix(ca.triu(ca.hessian(lagrangian, self.variables)[0]), lam, mu)

    def _matrix(self, matrix: SX, *weights: SX) -> Piece:
        rows, columns = (np.array(side, dtype=int) for side in matrix.sparsity().get_triplet())
        values = SX(matrix.nz[:]) if matrix.nnz() else SX(0, 1)
        return self._piece(values, rows, columns, *weights)

    def _plain(self, outputs: SX) -> Piece:
        none = np.array([], dtype=int)
        return self._piece(outputs, none, none)

    def _piece(self, outputs: SX, rows: Indices, columns: Indices, *weights: SX) -> Piece:
        """Only variables that the outputs use are arguments."""
        uses = ca.which_depends(outputs, self.variables, 1, False)
        used = np.flatnonzero(uses) if any(uses) else np.array([0])
        every = scalars(self.variables)
        symbols = ca.vertcat(*(every[int(i)] for i in used))
        function = ca.Function("stage", [symbols, self.constants, *weights], [outputs])
        return Piece(function, used, rows, columns)


def kernel_of(group: StageGroup) -> Kernel:
    """The kernel of a group: kept from the last group of the very same expressions."""
    parts = [group.variables, group.constants, group.rows.expression, group.sums]
    whole = ca.vertcat(*parts)
    key = (*(part.numel() for part in parts), *(one.element_hash() for one in scalars(whole)))
    return _KERNELS.get(key, lambda: _made(group, whole))


def _made(group: StageGroup, whole: SX) -> Kernel:
    rows, sums = group.rows.expression, group.sums
    plain = ca.Function("stage", [group.variables, group.constants], [rows, sums])
    size = plain.n_instructions()
    if size <= _SHARED:
        rows, sums = ca.cse([rows, sums])
    return Kernel(group.variables, group.constants, rows, sums, size, whole)


def _size(kernel: Kernel) -> int:
    """Derivatives are some ten times as long as what they are taken of."""
    return 10 * kernel.size


_KERNELS: Kept[Kernel] = Kept(_ROOM, _size)
