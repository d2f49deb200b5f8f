"""Small programs with complementarity, as the engine states its own."""

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from schemas.expressions import Tree, parse
from schemas.methods import Relaxation
from schemas.problem import SolverSettings
from schemas.results import HomotopyPass
from solver.backends import Watch
from solver.complementarity import (
    RELAXATION,
    Pair,
    Pairing,
    PairsWon,
    relaxation_cost,
    relaxation_rows,
    solve_pairs,
)
from solver.expressions import SX, evaluate
from solver.nlp.program import Program
from solver.nlp.scaling import Scaling, typical_scaling
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.task import NlpTask
from solver.nlp.variables import Variables

Array = NDArray[np.float64]
Limited = Mapping[str, tuple[float, float]]


class Stated(NamedTuple):
    """A program with pairs, ready to be solved."""

    names: tuple[str, ...]
    program: Program
    scaling: Scaling
    task: NlpTask
    pairing: Pairing

    def at(self, z: Array) -> dict[str, float]:
        """The variables by name at a scaled point."""
        return dict(zip(self.names, (z * self.scaling.columns).tolist(), strict=False))


def pair(first: str, second: str, **more: Any) -> Pair:
    """A pair of the only phase."""
    return Pair(0, f"{first} or {second}", first, second, **more)


def stated(
    variables: Mapping[str, tuple[float, float, float]],
    objective: str,
    pairs: Sequence[Pair],
    rows: Limited | None = None,
    form: str = "equality",
    scales: Mapping[str, float] | None = None,
) -> Stated:
    """Variable -> guess and limits; row's text -> limits; all at one node, where a step ends."""
    table, at, held = Variables(), np.array([1.0]), np.ones((1, 1))
    names = tuple(variables)
    guess, lower, upper = (np.array([one[i] for one in variables.values()]) for i in range(3))
    sizes = np.array([(scales or {}).get(name, 1.0) for name in names])
    limits = (lower[:, None], upper[:, None])
    columns = [
        table.add(0, names, at, limits, guess[:, None], sizes),
        table.add(None, (RELAXATION,), np.array([np.nan]), (held, held), held, np.ones(1)),
    ]
    symbols = {name: SX.sym(name) for name in (*names, RELAXATION)}
    cost = evaluate(parse(objective), symbols)
    if (price := relaxation_cost(form, pairs)) is not None:
        cost += evaluate(price, symbols)
    own = [*((text, parse(text), sides) for text, sides in (rows or {}).items())]
    own += relaxation_rows(form, pairs)
    group = StageGroup(
        0,
        ca.vertcat(*symbols.values()),
        SX(0, 1),
        np.concatenate(columns),
        np.zeros((0, 1)),
        _rows(own, symbols),
        cost,
    )
    program = Program(table, (group,))
    scaling = typical_scaling(program)
    task = NlpTask.of(program, scaling)
    return Stated(names, program, scaling, task, Pairing.of(program, scaling, pairs))


def _rows(rows: Sequence[tuple[str, Tree, tuple[float, float]]], symbols: dict[str, SX]) -> Rows:
    count = len(rows)
    return Rows(
        ca.vertcat(*(evaluate(tree, symbols) for _, tree, _ in rows)),
        tuple(f"path {label}" for label, *_ in rows),
        np.array([lower for *_, (lower, _) in rows]),
        np.array([upper for *_, (_, upper) in rows]),
        np.ones(count),
        np.ones((count, 1)),
    )


def watched(**changes: Any) -> Watch:
    """A watch that lets a solve run for a minute."""
    settings: dict[str, Any] = {
        "deadline": time.monotonic() + 60,
        "should_stop": lambda: False,
        "report": lambda *_: None,
    }
    return Watch(**(settings | changes))


def solved(
    posed: Stated,
    *,
    form: str = "equality",
    backend: str = "ipopt",
    watch: Callable[[], Watch] = watched,
    **relaxation: Any,
) -> PairsWon:
    """Solve, with changes of the relaxation."""
    passes: list[HomotopyPass] = []
    chosen = Relaxation.model_validate({"form": form} | relaxation)
    settings = SolverSettings.model_validate({"backend": backend, "max_iterations": 300})
    won = solve_pairs(posed.task, posed.pairing, chosen, settings, watch, passes.append)
    assert tuple(passes) == won.passes
    return won
