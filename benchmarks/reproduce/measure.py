"""Solves what a row asks for, in this process."""

import copy
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from typing import Any

import examples
from benchmarks.reproduce.judge import SOLVED
from benchmarks.reproduce.rows import Measured, Patch, Row
from benchmarks.reproduce.slip_sums import least_sums
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve

GUESSES = 20
"""Random guesses of a row that counts successes."""

MISSES = 1
"""So many of them may fail."""


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
    """Whole runs from random guesses: how many end well, and the least that they found."""
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        runs = list(pool.map(partial(run_from, row.example), range(GUESSES)))
    good = [end for end, counts in runs if counts]
    note = f"{len(good)}/{GUESSES} converge and are certified"
    if not good:
        return Measured(f"only {note}", None, None, 0, 0.0, note=note)
    best = min(good, key=lambda end: end.objective or 0.0)
    status = best.status if len(good) >= GUESSES - MISSES else f"only {note}"
    seconds = sum(end.seconds for end, _ in runs) / GUESSES
    return Measured(status, best.objective, best.error, best.segments, seconds, note=note)


def run_from(example: str, seed: int) -> tuple[Measured, bool]:
    """The example as it is, all stages and meshes, from a random guess; whether it counts."""
    problem = examples.load(example) | {"guess": {"kind": "random", "seed": seed}}
    for phase in problem["phases"]:
        phase.pop("guess", None)
    solution = solve(read_problem(problem))
    certified = solution.certificate.verdict == "certified"
    return _measured(solution), certified and solution.status is SolutionStatus.CONVERGED


def _audited(row: Row) -> Measured:
    """The example as it is, but for the row's changes: what its contacts did, and the audit."""
    solution = solve(read_problem(examples.load(row.example) | dict(row.changes)))
    found = _measured(solution)
    if solution.status is SolutionStatus.CONVERGED:
        return replace(found, note=_told(solution))
    failed = [row.name for row in solution.certificate.checks if row.judged and not row.passed]
    words = f"{solution.status.value.replace('_', ' ')}: {', '.join(failed) or 'not judged'}"
    return replace(found, status=words, note=words)


def _told(solution: Solution) -> str:
    modes, told = solution.mode_sequence, solution.complementarity
    words = ["certified"]
    if modes is not None:
        words.append(f"{len(modes.modes)} modes, {modes.distinct} of {modes.possible} possible")
    if told is not None and told.dissipation is not None:
        words.append(f"steps lose {told.dissipation:.0%} of the actuators' work")
    if told is not None and told.residual is not None:
        words.append(f"complementarity {told.residual:.0e}")
    return ", ".join(words)


def _sums(row: Row) -> Measured:
    """The seed's own transcription: sums over ten nodes."""
    began = time.perf_counter()
    value = least_sums()[row.changes["sum"]]
    return Measured("converged", value, None, 9, time.perf_counter() - began)


_KINDS: dict[str, Callable[[Row], Measured]] = {
    "solve": _solve,
    "audit": _audited,
    "random": _random,
    "sums": _sums,
}
