"""Which mesh is published where none is fine enough."""

import json
import math
from pathlib import Path

from schemas.reading import read_problem
from solver.meshes import solve_meshes
from solver.prepare import prepare
from solver.run import Run
from solver.solution.choose import choose
from tests.architecture.files import ROOT

CART_POLE = Path(ROOT) / "examples" / "cart_pole.json"


def test_of_two_too_coarse_the_more_accurate_one() -> None:
    refinement = {"tolerance": 1e-12, "max_segments": 40, "max_iterations": 2}
    problem = read_problem(json.loads(CART_POLE.read_text()) | {"refinement": refinement})
    run = Run(lambda _: None, math.inf, lambda: False)
    model, setting = prepare(problem)
    coarse, fine = solve_meshes(problem, model, setting, run, lambda _: None, warm=False)
    assert fine.max_error < coarse.max_error
    assert choose(problem, [coarse, fine]) is fine
    assert choose(problem, [fine, coarse]) is fine
