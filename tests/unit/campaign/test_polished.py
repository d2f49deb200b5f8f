"""Steps find the modes, hybrid collocation sharpens them."""

import pytest

from schemas.results import SolutionStatus
from solver import solve
from tests.support.pushed_block import EFFORT, pushed_block, reread


def test_the_polish_is_exact() -> None:
    method = {"kind": "contact_implicit_polished", "steps": {"kind": "contact_implicit"}}
    posed = reread(pushed_block(), method=method, refinement={"tolerance": 1e-8})
    solution = solve(posed)
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.objective == pytest.approx(EFFORT, rel=1e-8)
    assert [phase.name for phase in solution.phases] == [
        "move/mode_1",
        "move/mode_2",
        "move/mode_3",
    ]
    assert len(solution.stages) == 2
    assert solution.complementarity is not None
    assert solution.guessed_sequence is not None


def test_steps_that_find_nothing_end_it() -> None:
    steps = {"kind": "contact_implicit", "segments": 10}
    method = {"kind": "contact_implicit_polished", "steps": steps}
    document = pushed_block().model_dump(mode="json", exclude_defaults=True)
    document["phases"][0]["bounds"]["f"] = [-1, 1]  # less than friction holds
    solution = solve(reread(pushed_block(), phases=document["phases"], method=method))
    assert solution.status is not SolutionStatus.CONVERGED
    assert solution.message.startswith("By steps, before the polish: ")
    assert len(solution.stages) == 1
