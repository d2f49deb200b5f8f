"""Steps through contact, then hybrid collocation on the sequence that they found.

The steps are of first order, and give the modes; modes as phases of free durations, with impacts
between them, are solved to any accuracy from there.
"""

import time

from schemas.events import StageStarted
from schemas.mechanisms import Mode
from schemas.methods import ContactImplicitPolished, Hybrid, HybridMode
from schemas.periodic import Impact, Periodic
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import ModeSpan, Solution
from schemas.values import Bound, Scalar
from solver.campaign.once import SolveOnce
from solver.campaign.stages import GOOD_START, report, solution_guess
from solver.run import Run

STRETCH = 8.0
"""How much longer a mode may become."""

SHORTEST = 1e-7
"""Seconds that a mode lasts at the least."""


def solve_polished(problem: Problem, solve: SolveOnce, run: Run) -> Solution:
    """Solve a problem; one whose method is ``contact_implicit_polished`` in two goes.

    Returns
    -------
    What the second one comes to, with reports on both; the first one where it finds no motion.
    The guessed sequence is then that of the steps.
    """
    chosen = {
        index: method
        for index, phase in enumerate(problem.phases)
        if isinstance(method := phase.method or problem.method, ContactImplicitPolished)
    }
    if not chosen:
        return solve(problem, run)
    run.on_event(StageStarted(stage="build", note="by steps, to find the modes"))
    began = time.monotonic()
    steps = solve(_stepped(problem, chosen), run)
    reports = [report(steps, time.monotonic() - began)]
    found = steps.mode_sequence
    if steps.status not in GOOD_START or found is None or run.stopped():
        message = f"By steps, before the polish: {steps.message}"
        return _told(problem, steps.model_copy(update={"message": message, "stages": reports}))
    run.on_event(StageStarted(stage="build", note="the modes found, by collocation"))
    began = time.monotonic()
    phases = list(problem.phases)
    for index, method in chosen.items():
        first, last = steps.phases[index].knots[0], steps.phases[index].knots[-1]
        own = [mode for mode in found.modes if first <= (mode.start + mode.end) / 2 <= last]
        phases[index] = _scheduled(phases[index], method, own)
    scheduled = problem.model_copy(update={"phases": phases, "guess": solution_guess(steps)})
    polished = solve(scheduled, run)
    reports.append(report(polished, time.monotonic() - began))
    changed = {
        "stages": reports,
        "guessed_sequence": found,
        "complementarity": steps.complementarity,
        "message": f"{polished.message}{_by_steps(steps)}",
    }
    return _told(problem, polished.model_copy(update=changed))


def _by_steps(steps: Solution) -> str:
    value = steps.objective
    return "" if value is None else f" By steps the objective was {value:.6g}."


def _told(problem: Problem, solution: Solution) -> Solution:
    digest = {"spec_sha256": spec_sha256(problem)}
    reproduce = solution.reproduce.model_copy(update=digest)
    return solution.model_copy(update={"reproduce": reproduce})


def _stepped(problem: Problem, chosen: dict[int, ContactImplicitPolished]) -> Problem:
    """The problem by steps alone, on one mesh: it is refined afterwards."""
    phases = [
        phase.model_copy(update={"method": chosen[index].steps}) if index in chosen else phase
        for index, phase in enumerate(problem.phases)
    ]
    return problem.model_copy(update={"phases": phases, "refinement": None})


def _scheduled(phase: Phase, method: ContactImplicitPolished, modes: list[ModeSpan]) -> Phase:
    """The phase with the modes that were found."""
    sequence = [
        HybridMode(name=f"mode_{number}", contacts=_contacts(mode), duration=_about(mode))
        for number, mode in enumerate(_alike(modes), start=1)
    ]
    hybrid = Hybrid(kind="hybrid", transcription=method.transcription, sequence=sequence)
    return phase.model_copy(
        update={"method": hybrid, "guess": None, "periodic": _around(phase.periodic, sequence)}
    )


def _alike(modes: list[ModeSpan]) -> list[ModeSpan]:
    """Modes that differ in their contacts; joint limits are no modes of theirs."""
    found: list[ModeSpan] = []
    for mode in modes:
        if found and _contacts(found[-1]) == _contacts(mode):
            found[-1] = found[-1].model_copy(update={"end": mode.end})
        else:
            found.append(mode)
    return found


def _contacts(mode: ModeSpan) -> dict[str, Mode]:
    known: dict[str, Mode] = {
        "sticking": "sticking",
        "sliding_left": "sliding_left",
        "sliding_right": "sliding_right",
        "frictionless": "frictionless",
    }
    return {name: known[word] for name, word in mode.contacts.items() if word in known}


def _about(mode: ModeSpan) -> Bound:
    """How long a mode may last: also for no time, since steps may tell one too many."""
    length = mode.end - mode.start
    return Bound(Scalar(SHORTEST), Scalar(STRETCH * length))


def _around(periodic: Periodic | None, modes: list[HybridMode]) -> Periodic | None:
    """What lands and leaves where the last mode becomes the first one."""
    if periodic is None:
        return None
    before = set(modes[-1].contacts)
    after = {periodic.swapped(name) for name in modes[0].contacts}
    lands, leaves = sorted(after - before), sorted(before - after)
    impact = Impact(lands=lands, leaves=leaves) if lands else None
    return periodic.model_copy(update={"impact": impact})
