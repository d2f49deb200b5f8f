"""Start-up: what importing the api costs, against importing the engine.

Run: python -m benchmarks.imports
"""

import subprocess
import sys

from benchmarks.table import Row, in_turn, show, timed

RUNS = 5
HEAVY = ("casadi", "scipy", "matplotlib")


def main() -> None:
    """Print the table."""
    api, engine, bare = in_turn(
        RUNS,
        lambda: timed(lambda: run("import api.app")),
        lambda: timed(lambda: run("import solver")),
        lambda: timed(lambda: run("pass")),
    )
    loaded = run(f"import sys, api.app; print(*[m for m in {HEAVY} if m in sys.modules])")
    rows = [Row("import api", api - bare, engine - bare)]
    show("imports in a new process, medians, the interpreter's own start taken off", rows, "engine")
    print(f"heavy modules that the api loads: {loaded.strip() or 'none'} (aim: none, below 1 s)")


def run(code: str) -> str:
    """Run code in a new interpreter; what it prints."""
    command = [sys.executable, "-c", code]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout  # noqa: S603 - our own code


if __name__ == "__main__":
    main()
