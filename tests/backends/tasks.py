"""Programs for the backends, made as the engine makes them."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import examples
from schemas.problem import Problem, SolverSettings
from schemas.reading import read_problem
from solver.backends import Outcome, Watch, make_backend
from solver.complementarity import paired_scaling, unpaired
from solver.nlp.program import Program
from solver.nlp.redundancy import find_redundancy
from solver.nlp.scaling import Scaling, typical_scaling
from solver.nlp.task import NlpTask
from solver.posing import Posing
from solver.transcribe import transcribe
from tests.unit.solver.problems import block

INFEASIBLE = block(phase={"bounds": {"u": [-3, 3]}})
"""The block wants a force of 4 at the least."""

UNBOUNDED = block(objective={"minimize": "-effort"})


class Posed(NamedTuple):
    """A problem's first mesh as a program."""

    problem: Problem
    program: Program
    scaling: Scaling
    task: NlpTask


def posed(document: dict[str, Any]) -> Posed:
    """The first mesh of a problem."""
    posing = Posing.of(read_problem(document))
    model, setting = posing.prepared()
    program = equal = transcribe(model, setting).program
    scaling = typical_scaling(program)
    if setting.complementary is not None:
        scaling = paired_scaling(program, scaling, setting.complementary.pairs)
        equal = unpaired(program, setting.complementary.pairs)
    task = NlpTask.of(program, scaling)
    task = task.without(find_redundancy(equal, scaling, task.nlp))
    return Posed(posing.solved, program, scaling, task)


def example(name: str, **method: Any) -> dict[str, Any]:
    """An example, by another method."""
    document = examples.load(name)
    return document | {"method": document["method"] | method}


def watched(**changes: Any) -> Watch:
    """A watch that lets a solve run for a minute."""
    settings: dict[str, Any] = {
        "deadline": time.monotonic() + 60,
        "should_stop": lambda: False,
        "report": lambda *_: None,
    }
    return Watch(**(settings | changes))


def run(backend: str, task: NlpTask, watch: Watch | None = None, iterations: int = 500) -> Outcome:
    """Solve with a backend."""
    settings = SolverSettings(max_iterations=iterations)
    return make_backend(backend).solve(task, settings, watch or watched(), warm=False)


def after(calls: int) -> Callable[[], bool]:
    """Asks for a stop from the given call on."""
    asked = iter(range(10**9))
    return lambda: next(asked) >= calls
