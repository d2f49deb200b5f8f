"""Trees made ready for numpy: a straight list of steps, equal subexpressions computed once."""

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from schemas.expressions import Name, Tree, fold, names_in
from solver.numeric.functions import FUNCTIONS

Array = NDArray[np.float64]


class Step(NamedTuple):
    """``slots[target] = function(*slots[arguments])``."""

    target: int
    function: Callable[..., Any]
    arguments: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Tape:
    """Expressions as straight-line code over slots: inputs first, then constants and steps."""

    template: tuple[Any, ...]
    steps: tuple[Step, ...]
    outputs: tuple[int, ...]

    @property
    def reads(self) -> frozenset[int]:
        """The slots that are needed, inputs among them."""
        return frozenset(self.outputs).union(*(step.arguments for step in self.steps))

    def __call__(self, inputs: Sequence[Any], shape: tuple[int, ...]) -> Array:
        """Evaluate at many points at once.

        Parameters
        ----------
        inputs
            One array of ``shape``, or one that broadcasts to it, for each input.
        shape
            The shape of the set of points.

        Returns
        -------
        Shape (outputs, *shape). NaN and infinities come out where the mathematics has them.
        """
        slots = list(self.template)
        slots[: len(inputs)] = inputs
        with np.errstate(all="ignore"):
            for target, function, arguments in self.steps:
                slots[target] = function(*[slots[i] for i in arguments])
        result = np.empty((len(self.outputs), *shape))
        for row, slot in enumerate(self.outputs):
            result[row] = slots[slot]
        return result


@dataclass(frozen=True, slots=True)
class Scope:
    """What the names in an expression mean: points' inputs, constants, named intermediates.

    ``definitions`` are in an order in which each needs only those before it.
    """

    inputs: Sequence[str]
    constants: Mapping[str, float] = field(default_factory=dict)
    definitions: Mapping[str, Tree] = field(default_factory=dict)


def record(trees: Sequence[Tree], scope: Scope) -> Tape:
    """The tape of some expressions; intermediates that none of them uses leave no steps."""
    recorder = _Recorder(scope)
    needed = _needed(trees, scope.definitions)
    for name, tree in scope.definitions.items():
        if name in needed:
            recorder.define(name, tree)
    outputs = tuple(recorder.tree(tree) for tree in trees)
    return Tape(tuple(recorder.template), tuple(recorder.steps), outputs)


def _needed(trees: Sequence[Tree], definitions: Mapping[str, Tree]) -> set[str]:
    """The intermediates behind some expressions; chains of them may be long."""
    needed, pending = set[str](), list(trees)
    while pending:
        for name in names_in(pending.pop()):
            if name.name in definitions and name.name not in needed:
                needed.add(name.name)
                pending.append(definitions[name.name])
    return needed


class _Recorder:
    """Folds trees into slots. A slot whose template is not None is a constant."""

    def __init__(self, scope: Scope) -> None:
        self.template: list[Any] = [None] * len(scope.inputs)
        self.steps: list[Step] = []
        self._names = {name: slot for slot, name in enumerate(scope.inputs)}
        self._shared: dict[object, int] = {}
        self._calls = {name: functools.partial(self._call, name) for name in FUNCTIONS}
        for name, value in scope.constants.items():
            self._names[name] = self._number(value)

    def tree(self, tree: Tree) -> int:
        return fold(tree, self._calls, self._lookup, self._number)

    def define(self, name: str, tree: Tree) -> None:
        """Give an intermediate its name."""
        self._names[name] = self.tree(tree)

    def _lookup(self, name: Name) -> int:
        return self._names[name.name]

    def _number(self, value: float) -> int:
        # float64, not float: 1/0 is then inf as in arrays, and no ZeroDivisionError.
        return self._share(float(value).hex(), np.float64(value))

    def _call(self, name: str, *arguments: int) -> int:
        if len(arguments) > 2:
            return functools.reduce(self._calls[name], arguments)
        key = (name, arguments)
        if key in self._shared:
            return self._shared[key]
        function, values = FUNCTIONS[name], [self.template[i] for i in arguments]
        if all(value is not None for value in values):
            with np.errstate(all="ignore"):
                return self._share(key, function(*values))
        self.steps.append(Step(len(self.template), function, arguments))
        return self._share(key, None)

    def _share(self, key: object, value: Any) -> int:
        if key not in self._shared:
            self._shared[key] = len(self.template)
            self.template.append(value)
        return self._shared[key]
