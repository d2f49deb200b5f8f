"""Reading a simulation: JSON, then its shape, then its meaning."""

from collections.abc import Callable

from pydantic import ValidationError

from schemas.complaints import issue_of
from schemas.errors import BadProblem
from schemas.reading import (
    MAX_ISSUES,
    Document,
    misdirected,
    read_document,
    read_inlined,
    refuse,
)
from schemas.simulations.checks import check
from schemas.simulations.document import Simulation


def read_simulation(
    data: bytes | str | Document, inline: Callable[[Document], Document] | None = None
) -> Simulation:
    """Read and check a simulation, with the care of `schemas.reading.read_problem`.

    Parameters
    ----------
    data
        JSON, as bytes in UTF-8 or as text, or what ``json.loads`` made of it.
    inline
        Puts in what the document only names (``schemas.inlining``); the same object if nothing.

    Raises
    ------
    BadProblem
        With every issue found by the first step that found any; at most `MAX_ISSUES` are kept.
    """
    document = read_document(data, "simulation")
    refuse(misdirected(document, "simulation"))
    if inline is not None:
        document = read_inlined(document, inline)
    try:
        simulation = Simulation.model_validate(document)
    except ValidationError as error:
        details = error.errors(include_url=False)
        issues = [issue_of(detail, Simulation) for detail in details[:MAX_ISSUES]]
        raise BadProblem(issues) from None
    refuse(check(simulation))
    return simulation
