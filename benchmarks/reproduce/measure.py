"""Solves what a row asks for, in this process."""

import copy
import time
from collections.abc import Callable
from typing import Any

import examples
from benchmarks.reproduce.judge import SOLVED
from benchmarks.reproduce.rows import Measured, Patch, Row
from benchmarks.reproduce.slip_sums import least_sums
from schemas.reading import read_problem
from schemas.results import Solution
from solver import solve

GUESSES = 20
"""Random guesses of a row that counts successes."""


def measure(row: Row) -> Measured:
    """The row on its own mesh and, where it has a refinement, on refined ones."""
    return _KINDS[row.kind](row)


def document(row: Row, refinement: Patch | None, changes: Patch) -> dict[str, Any]:
    """The problem of a row as JSON values.

    The last stage has the refinement, those before it one mesh each.
    """
    problem = copy.deepcopy(
        examples.load(row.example)
        | {"refinement": None if refinement is None else dict(refinement)}
        | dict(row.changes)
        | dict(changes)
    )
    fine = problem["refinement"]
    stages = problem.get("stages", [])
    for number, stage in enumerate(stages, 1):
        stage["refinement"] = fine if number == len(stages) else None
    return problem


def _solve(row: Row) -> Measured:
    coarse = solve(read_problem(document(row, None, {})))
    plain = _measured(coarse)
    if row.refinement is None or plain.status not in SOLVED:
        return plain
    fine = _measured(solve(read_problem(document(row, row.refinement, row.refined))))
    note = "" if fine.status in SOLVED else f"refined: {fine.status}"
    return Measured(
        plain.status,
        plain.objective,
        plain.error,
        plain.segments,
        plain.seconds,
        fine.objective if not note else None,
        fine.segments,
        note,
    )


def _measured(solution: Solution) -> Measured:
    """The last mesh; the seconds of building and solving on all of them."""
    meshes = solution.mesh_refinement.iterations
    return Measured(
        solution.status.value,
        solution.objective,
        meshes[-1].max_error if meshes else None,
        meshes[-1].segments if meshes else 0,
        sum(stage.seconds for stage in solution.stages)
        or solution.timing.build + solution.timing.solve,
    )


def _random(row: Row) -> Measured:
    """The same from random guesses: how many end well, and the least that they found."""
    began = time.perf_counter()
    ends = [_measured(solve(read_problem(_shaken(row, seed)))) for seed in range(GUESSES)]
    good = [end for end in ends if end.status in SOLVED and end.objective is not None]
    seconds = (time.perf_counter() - began) / GUESSES
    note = f"{len(good)}/{GUESSES} succeed"
    if not good:
        return Measured("locally_infeasible", None, None, 0, seconds, note=note)
    best = min(good, key=lambda end: end.objective or 0.0)
    status = best.status if len(good) >= GUESSES - 1 else f"only {note}"
    return Measured(status, best.objective, best.error, best.segments, seconds, note=note)


def _shaken(row: Row, seed: int) -> dict[str, Any]:
    problem = document(row, None, {"guess": {"kind": "random", "seed": seed}})
    for phase in problem["phases"]:
        phase.pop("guess", None)
    return problem


def _sums(row: Row) -> Measured:
    """The seed's own transcription: sums over ten nodes."""
    began = time.perf_counter()
    value = least_sums()[row.changes["sum"]]
    return Measured("converged", value, None, 9, time.perf_counter() - began)


_KINDS: dict[str, Callable[[Row], Measured]] = {
    "solve": _solve,
    "random": _random,
    "sums": _sums,
}
