"""What the author of a good problem may want to know before it is solved."""

from collections.abc import Iterator
from itertools import pairwise

from schemas.corners import corners
from schemas.expressions import names_in
from schemas.guesses import RandomGuess
from schemas.problem import Problem


def remarks(problem: Problem) -> Iterator[str]:
    """On several starts, on phases that nothing ties together, on corners; each with its place."""
    if problem.multistart > 1 and not isinstance(problem.guess, RandomGuess):
        yield (
            "/multistart: the first guess is the problem's own, the others are random ones with "
            f"the seeds 1 to {problem.multistart - 1}"
        )
    yield from untied(problem)
    yield from corners(problem)


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
