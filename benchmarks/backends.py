"""The NLP solvers side by side: ``python -m benchmarks.backends`` prints the table of the docs.

Seconds are the solver's own, the least of five runs; building the program is not counted.
"""

import time
from collections.abc import Sequence

import examples
from schemas.problem import SolverSettings
from schemas.reading import read_problem
from solver.backends import BACKENDS, NlpStatus, Outcome, Watch, make_backend
from solver.nlp.redundancy import find_redundancy
from solver.nlp.scaling import typical_scaling
from solver.nlp.task import NlpTask
from solver.prepare import prepare
from solver.transcribe import transcribe

NAMES = (
    "block_min_force",
    "linear_quadratic",
    "cart_pole",
    "double_integrator",
    "bryson_denham",
    "brachistochrone",
    "moon_landing",
    "pendulum_torque_limited",
)
RUNS = 5
SECONDS = 60.0


def main() -> None:
    """Print the table."""
    print(f"| first mesh of | variables | {' | '.join(BACKENDS)} |")
    print("|---|---|" + "---|" * len(BACKENDS))
    for name in NAMES:
        task = _task(name)
        cells = [_cell(backend, task) for backend in BACKENDS]
        print(f"| {name} | {len(task.start)} | {' | '.join(cells)} |")


def _task(name: str) -> NlpTask:
    """The first mesh of an example as a program."""
    program = transcribe(*prepare(read_problem(examples.load(name)))).program
    scaling = typical_scaling(program)
    task = NlpTask.of(program, scaling)
    return task.without(find_redundancy(program, scaling, task.nlp))


def _cell(backend: str, task: NlpTask) -> str:
    """Milliseconds and iterations, or why not."""
    if make_backend(backend).refusal(task):
        return "refused"
    outcomes = [_solve(backend, task) for _ in range(RUNS)]
    return _words(outcomes)


def _solve(backend: str, task: NlpTask) -> Outcome:
    watch = Watch(time.monotonic() + SECONDS, lambda: False, lambda *_: None)
    return make_backend(backend).solve(task, SolverSettings(), watch, warm=False)


def _words(outcomes: Sequence[Outcome]) -> str:
    if outcomes[0].status is not NlpStatus.OPTIMAL:
        return outcomes[0].status.replace("_", " ")
    seconds = min(outcome.seconds for outcome in outcomes)
    return f"{seconds * 1e3:.1f} ms, {outcomes[0].iterations}"


if __name__ == "__main__":
    main()
