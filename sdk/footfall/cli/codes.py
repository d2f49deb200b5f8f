"""The exit codes of the command, as the contract names them."""

from footfall.errors import BadFile, BadProblem, FootfallError

CONVERGED = 0
FAULT = 1
BAD_INPUT = 2
OTHERWISE = 3
INTERRUPTED = 130


_WELL = frozenset({"converged", "finished", "stopped"})
"""Of a solve; of a simulation that came to its end, or to an event that was to end it."""


def of_status(status: str) -> int:
    """The code for a result: 0 for one that ended well, else 3."""
    return CONVERGED if status in _WELL else OTHERWISE


def of_error(error: FootfallError) -> int:
    """The code for an error: 2 where the user's problem or file is at fault, else 1."""
    return BAD_INPUT if isinstance(error, BadFile | BadProblem) else FAULT
