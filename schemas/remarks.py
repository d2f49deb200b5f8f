"""What the author of a good problem may want to know before it is solved."""

from collections.abc import Iterator
from itertools import pairwise

from schemas.checks.masses import Numbers
from schemas.corners import corners
from schemas.expressions import names_in
from schemas.guesses import RandomGuess
from schemas.mechanisms import Mechanism
from schemas.mechanisms.four_bars import change_points
from schemas.problem import Problem
from schemas.simulations.document import Simulation, TimeStepping
from schemas.stepping import stepping
from schemas.suspicions import suspicions
from schemas.urdf import Urdf
from schemas.values import Bound


def remarks(problem: Problem) -> Iterator[str]:
    """On several starts, loose phases, linkages that fold flat, corners; each with its place."""
    if problem.multistart > 1 and not isinstance(problem.guess, RandomGuess):
        yield (
            "/multistart: the first guess is the problem's own, the others are random ones with "
            f"the seeds 1 to {problem.multistart - 1}"
        )
    yield from untied(problem)
    yield from folding(problem)
    yield from corners(problem)
    yield from doubtful(problem)
    yield from stepping(problem)
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Urdf):
            for remark in phase.system.tree.remarks:
                yield f"/phases/{index}/system/text: {remark}"


def simulated_remarks(simulation: Simulation) -> Iterator[str]:
    """The same of a simulation."""
    initial = {name: Bound(value, value) for name, value in simulation.initial.items()}
    yield from suspicions(simulation.system, {"initial": initial}, ())
    method, span = simulation.method, simulation.duration.source
    if isinstance(method, TimeStepping) and isinstance(span, float) and method.step > span:
        yield (
            f"/method/step: one step of {method.step:g} s is longer than the duration, {span:g} s: "
            "take a shorter one"
        )


def doubtful(problem: Problem) -> Iterator[str]:
    """Angles that look like degrees, and motors that share a joint."""
    for index, phase in enumerate(problem.phases):
        ends = {"bounds": phase.bounds, "initial": phase.initial, "final": phase.final}
        yield from suspicions(phase.system, ends, ("phases", index))


def untied(problem: Problem) -> Iterator[str]:
    """One line for each phase that no linkage ties to a phase before it."""
    met = [
        {name.name.partition(".")[0] for name in names_in(linkage.expression.tree)}
        for linkage in problem.linkages
    ]
    before: set[str] = set()
    for last, phase in pairwise(problem.phases):
        before.add(last.name)
        if not any(phase.name in names and names & before for names in met):
            yield (
                f"/linkages: nothing ties '{phase.name}' to a phase before it; for a state that "
                f"carries over link {phase.name}.initial.NAME to {last.name}.final.NAME"
            )


def folding(problem: Problem) -> Iterator[str]:
    """One line for each loop of four bars that folds flat, where it may go on in two ways."""
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Mechanism):
            numbers = Numbers.of(phase, index)
            for name in change_points(phase.system, numbers.value):
                yield (
                    f"{numbers.at('loops', name)}: a change-point four-bar: its shortest and "
                    "longest bars are together as long as the others, so it can fold flat, and "
                    "from there go on in two ways; keep it from the fold by bounds on a joint"
                )
