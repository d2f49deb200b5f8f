"""Where the controls of a solved phase switch: jumps, and changes of what is active."""

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from schemas import resolve
from schemas.expressions import Call, Name, Tree, walk
from schemas.phases import Phase
from solver.lowering import Form
from solver.numeric import Array
from solver.switches.changes import changes, jumps
from solver.switches.samples import Samples

ACTIVE = 1e-3
"""How near to its limit a control is active, relative to its range; and for the sign of zero."""

TOUCHING = 1e-5
"""The same for states and path constraints, which may come near to a limit for long, smoothly."""

NEAR = 2.5
"""Switches nearer than so many segments to each other are one."""

AT_END = 0.75
"""Segments: a switch nearer than this to an end of the phase is none."""

MOST = 20
"""More switches than these are a chatter, or a mesh too coarse to tell."""


def detect(phase: Phase, samples: Samples, *, kinks: bool = True) -> list[float]:
    """The times in seconds, increasing, at which the motion is likely not to be smooth.

    Jumps of controls; with ``kinks`` also changes of the activity of bounds and of path
    constraints, and sign changes of what stands under ``abs``, and of what ``min`` and ``max``
    compare, in integrals. Only what lasts on both sides counts. Empty where nothing steers the
    phase, and where there are too many switches.
    """
    names = phase.system.control_names
    labels = itertools.chain(_activity(phase, samples), _turns(phase, samples))
    times = _together(
        samples,
        [time for name in names for time in _jumps(phase, samples, name)],
        [time for own in labels for time in changes(samples, own)] if kinks and names else [],
    )
    return times if len(times) <= MOST else []


def _jumps(phase: Phase, samples: Samples, name: str) -> list[float]:
    values = samples.value(Name(name))
    lower, upper = resolve.interval(phase.bounds.get(name), samples.form.constants)
    width = upper - lower if math.isfinite(upper - lower) else 0.0
    return jumps(samples, values, max(width, float(np.max(np.abs(values)))))


def _activity(phase: Phase, samples: Samples) -> Iterator[NDArray[np.int_]]:
    """-1 at the lower limit, 1 at the upper one, 0 between, for all that has limits."""
    constants = samples.form.constants
    for name, bound in phase.bounds.items():
        share = ACTIVE if name in samples.form.controls else TOUCHING
        yield _limited(samples.value(Name(name)), resolve.interval(bound, constants), share)
    for row in phase.path:
        values = samples.value(row.expression.tree)
        yield _limited(values, resolve.interval(row, constants), TOUCHING)


def _limited(values: Array, limits: tuple[float, float], share: float) -> NDArray[np.int_]:
    lower, upper = limits
    if not upper > lower or not np.isfinite(values).all():
        return np.zeros(values.shape, dtype=int)
    close = share * (upper - lower if math.isfinite(upper - lower) else float(np.ptp(values)))
    return np.where(values <= lower + close, -1, np.where(values >= upper - close, 1, 0))


def _turns(phase: Phase, samples: Samples) -> Iterator[NDArray[np.int_]]:
    """The signs of what ``abs``, ``min`` and ``max`` turn on."""
    for expression in phase.integrals.values():
        for tree in _turning(expression.tree, samples.form):
            values = samples.value(tree)
            if np.isfinite(values).all():
                close = ACTIVE * float(np.max(np.abs(values)))
                yield np.where(np.abs(values) <= close, 0, np.sign(values)).astype(int)


def _turning(tree: Tree, form: Form) -> Iterator[Tree]:
    """What is zero where the tree has a kink, that of its intermediates included."""
    trees, seen = [tree], set[str]()
    while trees:
        for node in walk(trees.pop()):
            if isinstance(node, Name) and node.name in form.definitions and node.name not in seen:
                seen.add(node.name)
                trees.append(form.definitions[node.name])
            elif isinstance(node, Call) and node.function == "abs":
                yield node.arguments[0]
            elif isinstance(node, Call) and node.function in ("min", "max"):
                for pair in itertools.combinations(node.arguments, 2):
                    yield Call("-", pair)


def _together(samples: Samples, sure: list[float], kinks: list[float]) -> list[float]:
    """One time for those that are close to each other: the jumps' where there are any."""
    groups: list[list[tuple[float, bool]]] = []
    marked = [(time, True) for time in sure] + [(time, False) for time in kinks]
    for time, jump in sorted(marked):
        if groups and time - groups[-1][-1][0] <= NEAR * samples.width(time):
            groups[-1].append((time, jump))
        else:
            groups.append([(time, jump)])
    times = [
        float(np.mean([t for t, jump in group if jump] or [t for t, _ in group]))
        for group in groups
    ]
    start, end = samples.knots[0], samples.knots[-1]
    return [t for t in times if min(t - start, end - t) > AT_END * samples.width(t)]
