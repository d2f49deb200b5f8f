"""What is odd about a program before it is solved: sizes far from 1, variables without a use."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from solver.nlp.program import Program
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]

_LARGE = 1e6
_SMALL = 1e-6
_NUDGE = 1e-2  # of each variable's size: a slope that is zero at the guess may not be so beside it

Groups = dict[tuple[str, int | None], float]
"""The largest or smallest slope of each group of rows or variables: name and phase."""


def scale_warnings(program: Program, task: NlpTask, phases: Sequence[str]) -> list[str]:
    """Rows and variables whose slopes at the start stay far from 1, although scaled.

    ``phases`` has the phases' names. One line for each name and phase.
    """
    jacobian = task.nlp.jacobian(task.start, [])[1]
    slopes = np.nan_to_num(np.abs(jacobian.nonzeros()), posinf=0.0)  # those are told elsewhere
    rows, columns = np.zeros(program.rows), np.zeros(program.variables.size)
    np.maximum.at(rows, jacobian.row(), slopes)
    np.maximum.at(columns, np.repeat(np.arange(len(columns)), np.diff(jacobian.colind())), slopes)
    if not (_odd(rows).any() or _odd(columns).any()):
        return []
    found = [*_rows(program, rows).items(), *_columns(program, columns).items()]
    return [_line(name, _place(phase, phases), size) for (name, phase), size in found]


def unused_warnings(program: Program, task: NlpTask, phases: Sequence[str]) -> list[str]:
    """Controls and parameters that nothing depends on, by name."""
    used = np.zeros(program.variables.size, dtype=bool)
    used |= np.diff(task.nlp.jacobian.sparsity_out(1).colind()) > 0
    hessian = task.nlp.hessian.sparsity_out(0)
    used |= np.diff(hessian.colind()) > 0
    used[hessian.row()] = True
    if used.all():
        return []
    for point in (task.start, task.start + _NUDGE):
        used |= task.nlp.gradient(point, [])[1].full().ravel() != 0
    uses: dict[tuple[str, int | None], bool] = {}
    for block in program.variables.blocks:
        for name, places in zip(block.names, block.indices, strict=True):
            key = (name, block.phase)
            uses[key] = uses.get(key, False) or bool(used[places].any())
    return [
        f"'{name}'{_place(phase, phases)} has no effect on anything: its values mean nothing."
        for (name, phase), use in uses.items()
        if not use
    ]


def _odd(sizes: Array) -> NDArray[np.bool_]:
    """Sizes far from 1; zero is no size."""
    return (sizes > _LARGE) | ((sizes > 0) & (sizes < _SMALL))


def _rows(program: Program, sizes: Array) -> Groups:
    labels = list(program.labels())
    found = (
        (labels[row].name, labels[row].phase, sizes[row]) for row in np.flatnonzero(_odd(sizes))
    )
    return _worst(found)


def _columns(program: Program, sizes: Array) -> Groups:
    odd = _odd(sizes)
    return _worst(
        (name, block.phase, size)
        for block in program.variables.blocks
        for name, places in zip(block.names, block.indices, strict=True)
        for size in sizes[places[odd[places]]]
    )


def _worst(found: Iterator[tuple[str, int | None, float]]) -> Groups:
    groups: Groups = {}
    for name, phase, size in found:
        before = groups.get((name, phase), size)
        groups[name, phase] = max(before, size, key=lambda each: abs(np.log(each)))
    return groups


def _place(phase: int | None, phases: Sequence[str]) -> str:
    return "" if phase is None else f" in phase {phases[phase]}"


def _line(name: str, place: str, size: float) -> str:
    return (
        f"'{name}'{place} is badly scaled: its slopes at the guess are of size {size:.0e}. "
        "Other units, or bounds that say how large things get, make it easier to solve."
    )
