"""One contact-implicit example by one backend, in a process of its own; prints a line of JSON.

Each pass is told on stderr as it ends.

    python -m benchmarks.peers.with_snopt EXAMPLE STEPS snopt|ipopt SECONDS FOLDER

FOLDER holds ``pydrake`` beside what we have installed ourselves. Everything but the NLP solver is
the same for both: guess, scaling, schedule of relaxations, polish, certificate.
"""

import json
import sys
import time
from dataclasses import dataclass, field
from unittest import mock

import examples
from schemas.problem import SolverSettings
from schemas.reading import read_problem
from solver import solve
from solver.backends import DEFAULT, Backend, NlpStatus, Outcome, Strategy, Watch
from solver.backends.ipopt import Ipopt
from solver.nlp.task import NlpTask


@dataclass
class Timed(Backend):
    """A backend, and the processor seconds of its solves. ``passes`` tells how each ended."""

    inner: Backend
    seconds: float = 0.0
    iterations: int = 0
    passes: list[str] = field(default_factory=list)

    name = "timed"
    statuses: dict[str, NlpStatus] = field(default_factory=dict)  # type: ignore[misc]

    def available(self) -> bool:
        """As the backend is."""
        return self.inner.available()

    def refusal(self, task: NlpTask) -> str:
        """As the backend's."""
        return self.inner.refusal(task)

    def offers(self, strategy: Strategy) -> bool:
        """As the backend does."""
        return self.inner.offers(strategy)

    def solve(
        self,
        task: NlpTask,
        settings: SolverSettings,
        watch: Watch,
        *,
        warm: bool,
        strategy: Strategy = DEFAULT,
    ) -> Outcome:
        """Solve, and take the time."""
        began = time.process_time()
        outcome = self.inner.solve(task, settings, watch, warm=warm, strategy=strategy)
        self.seconds += time.process_time() - began
        self.iterations += outcome.iterations
        self.passes.append(f"{outcome.status} {outcome.iterations}")
        print(self.passes[-1], file=sys.stderr, flush=True)
        return outcome


def main() -> None:
    """Do what the command line says."""
    example, steps, name, seconds, folder = sys.argv[1:]
    backend = Timed(Ipopt() if name == "ipopt" else _snopt(folder))
    document = examples.load(example)
    method = document["method"] | {"segments": int(steps)}
    changed = {"method": method, "refinement": None, "limits": {"seconds": float(seconds)}}
    with mock.patch("solver.complementarity.solve.make_backend", return_value=backend):
        solution = solve(read_problem(document | changed))
    answer = {
        "status": str(solution.status),
        "objective": solution.objective,
        "iterations": backend.iterations,
        "seconds": backend.seconds,
        "inside": getattr(backend.inner, "inside", 0.0),
        "passes": backend.passes,
    }
    print(json.dumps(answer))


def _snopt(folder: str) -> Backend:
    sys.path.append(folder)
    from benchmarks.peers.snopt import Snopt  # noqa: PLC0415 - needs the folder

    return Snopt()


if __name__ == "__main__":
    main()
