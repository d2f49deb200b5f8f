"""Engines for tests of the worker: they do what the document's name says, at once.

``quick`` solves; ``gated`` waits for the file FOOTFALL_TEST_GATE, or to be stopped; ``deaf``
waits for the same and cannot be stopped; ``deadly`` kills its own process; ``hungry`` allocates
without end; ``broken`` raises; ``senseless`` is refused by the model; ``chatty`` sends events.
"""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

from schemas.errors import InvalidModel, Issue
from schemas.events import Advanced, EngineEvent, MeshSolved, NlpIteration, StageStarted
from schemas.problem import Problem
from schemas.results import (
    Certificate,
    MeshRefinement,
    Reproduce,
    Solution,
    SolutionStatus,
    SolverReport,
    Timing,
)
from schemas.simulated import SimulationResult, SimulationStatus, SimulationTiming
from schemas.simulations import Simulation
from worker.attempt import Engines

Ask = Callable[[], bool]
Tell = Callable[[EngineEvent], None]
Keep = Callable[[Solution], None]


def scripted(
    problem: Problem,
    on_event: Tell,
    deadline: float | None,
    should_stop: Ask,
    on_snapshot: Keep,
) -> Solution:
    """Act by the problem's name."""
    on_event(StageStarted(stage="solve"))
    status = SolutionStatus.CONVERGED
    match problem.name:
        case "gated":
            status = _gated(deadline, should_stop)
        case "deaf":
            on_snapshot(solution("deaf", SolutionStatus.CANCELLED))
            _gated(None, lambda: False)
        case "deadly":
            os.kill(os.getpid(), signal.SIGKILL)
        case "hungry":
            _hungry()
        case "broken":
            raise RuntimeError("the solver broke\nin two lines")
        case "senseless":
            raise InvalidModel([Issue("/phases/0/system", "The dynamics are NaN.", "Guess again.")])
        case "chatty":
            _chatty(on_event)
    return solution(problem.name, status)


def simulated(
    simulation: Simulation, on_event: Tell, deadline: float, should_stop: Ask
) -> SimulationResult:
    """Act by the simulation's name: ``gated``, ``broken`` and ``senseless`` as above."""
    on_event(StageStarted(stage="simulate"))
    status = SimulationStatus.FINISHED
    match simulation.name:
        case "gated":
            on_event(Advanced(time=0.5, end=2.0))
            status = _OF_SOLVE[_gated(deadline, should_stop)]
        case "broken":
            raise RuntimeError("the integrator broke")
        case "senseless":
            raise InvalidModel([Issue("/system", "The loops cannot close.", "Look again.")])
    return motion(simulation.name, status)


def motion(name: str, status: SimulationStatus) -> SimulationResult:
    """The result of a simulation without phases."""
    return SimulationResult(
        name=name,
        status=status,
        message=f"ended as {status}",
        phases=[],
        timing=SimulationTiming(build=0.0, simulate=0.0, total=0.0),
        reproduce=Reproduce(spec_sha256="", versions={}),
    )


_OF_SOLVE = {
    SolutionStatus.CONVERGED: SimulationStatus.FINISHED,
    SolutionStatus.CANCELLED: SimulationStatus.CANCELLED,
    SolutionStatus.TIME_LIMIT: SimulationStatus.TIME_LIMIT,
}


def solution(name: str, status: SolutionStatus) -> Solution:
    """A solution without phases."""
    return Solution(
        name=name,
        status=status,
        objective=1.0,
        message=f"ended as {status}",
        phases=[],
        mesh_refinement=MeshRefinement(tolerance=None, converged=True, iterations=[]),
        certificate=Certificate(verdict="not_checked", checks=[]),
        solver=SolverReport(
            backend="none", iterations=0, status="", residuals=[], variables=0, constraints=0
        ),
        timing=Timing(build=0.0, solve=0.0, refine=0.0, certify=0.0, total=0.0),
        reproduce=Reproduce(spec_sha256="", versions={}),
    )


def page(result: dict[str, object], problem: dict[str, object]) -> str:
    """A report; the problem named ``pageless`` breaks it."""
    if problem["name"] == "pageless":
        raise ValueError("no page today")
    return f"<html>{result['name']}</html>"


def _gated(deadline: float | None, should_stop: Ask) -> SolutionStatus:
    gate = Path(os.environ["FOOTFALL_TEST_GATE"])
    while not gate.exists():
        if should_stop():
            return SolutionStatus.CANCELLED
        if deadline is not None and time.monotonic() > deadline:
            return SolutionStatus.TIME_LIMIT
        time.sleep(0.01)
    return SolutionStatus.CONVERGED


def _hungry() -> None:
    eaten = []
    while True:
        eaten.append(bytearray(16 << 20))


def _chatty(on_event: Tell) -> None:
    for iteration in range(500):
        on_event(
            NlpIteration(mesh=0, iteration=iteration, objective=1.0, violation=0.5, seconds=0.0)
        )
    for mesh in range(3):
        on_event(
            MeshSolved(
                mesh=mesh,
                segments=10,
                max_error=0.1,
                tolerance=0.1,
                objective=2.0,
                nlp_iterations=5,
                seconds=0.0,
            )
        )


ENGINES = Engines(scripted, simulated, page)
