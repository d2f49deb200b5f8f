"""The small jobs before the first one."""

from typing import Any

from footfall.report import render
from schemas.results import Solution, SolutionStatus
from schemas.simulated import SimulationResult, SimulationStatus
from solver import solve
from solver.simulation import simulate
from worker.attempt import Engines
from worker.warming import warm_up


def test_it_walks_the_whole_way_and_ends_well() -> None:
    solved: list[Solution] = []
    simulated: list[SimulationResult] = []
    pages: list[str] = []

    def engine(problem: Any, **options: Any) -> Solution:
        solved.append(solve(problem, **options))
        return solved[0]

    def simulator(simulation: Any, **options: Any) -> SimulationResult:
        simulated.append(simulate(simulation, **options))
        return simulated[0]

    def draw(result: dict[str, Any], problem: dict[str, Any]) -> str:
        pages.append(render(result, problem))
        return pages[-1]

    warm_up(Engines(engine, simulator, draw))
    assert solved[0].status is SolutionStatus.CONVERGED
    assert len(solved[0].mesh_refinement.iterations) == 2
    assert simulated[0].status is SimulationStatus.FINISHED
    assert len(pages) == 2
