"""From words on the command line to one command, and from errors to an exit code."""

import os
import sys
from collections.abc import Sequence

from footfall.cli import codes
from footfall.cli.output import complain
from footfall.cli.words import parser
from footfall.errors import FootfallError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; the exit code.

    0 done (a result: converged), 1 fault, 2 bad problem or command line, 3 a result that has not
    converged, 130 interrupted.
    """
    options = parser(os.environ).parse_args(arguments)
    try:
        code: int = options.run(options)
        sys.stdout.flush()
    except FootfallError as error:
        complain(error, as_json=options.json)
        return codes.of_error(error)
    except BrokenPipeError:  # the reader of our output has enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return codes.FAULT
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return codes.INTERRUPTED
    return code
