"""The small solve before the first job."""

from typing import Any

from footfall.report import render
from schemas.results import Solution, SolutionStatus
from solver import solve
from worker.warming import warm_up


def test_it_walks_the_whole_way_and_ends_well() -> None:
    solved: list[Solution] = []
    pages: list[str] = []

    def engine(problem: Any, **options: Any) -> Solution:
        solved.append(solve(problem, **options))
        return solved[0]

    def draw(result: dict[str, Any], problem: dict[str, Any]) -> str:
        pages.append(render(result, problem))
        return pages[0]

    warm_up(engine, draw)
    assert solved[0].status is SolutionStatus.CONVERGED
    assert len(solved[0].mesh_refinement.iterations) == 2
    assert pages
