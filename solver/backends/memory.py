"""Missing memory, told from an infeasible problem.

IPOPT's linear solver says that memory ran out in IPOPT's log alone; the return status is that of
a failed restoration. So where the process has a limit, the log is kept for the length of a solve.
"""

import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

_LEVEL = 5  # the least at which IPOPT passes the linear solver's words on


def _nothing() -> None:
    """No limit, no log."""


@contextmanager
def memory_watch(options: dict[str, Any]) -> Iterator[Callable[[], None]]:
    """Add the log to IPOPT's options, where the process has a limit.

    Yields
    ------
    What to call after a failed solve: raises MemoryError if memory was the reason.
    """
    if resource.getrlimit(resource.RLIMIT_AS)[0] == resource.RLIM_INFINITY:
        yield _nothing
        return
    with TemporaryDirectory(prefix="footfall-ipopt-") as folder:
        log = Path(folder) / "log"
        options |= {"ipopt.output_file": str(log), "ipopt.file_print_level": _LEVEL}

        def check() -> None:
            if log.exists() and "out of memory" in log.read_text(errors="replace"):
                raise MemoryError("the linear solver ran out of memory")

        yield check


@contextmanager
def memory_told() -> Iterator[None]:
    """CasADi's word for missing memory, a RuntimeError, as the MemoryError that it is."""
    try:
        yield
    except RuntimeError as error:
        if "bad_alloc" in str(error):
            raise MemoryError("the engine ran out of memory") from error
        raise
