"""Contact-implicit programs by Drake's SNOPT beside ours: the same programs, passes and polish.

Run: python -m benchmarks.contact_snopt. A process each; processor seconds in the NLP solvers, over
all passes of the homotopy and the polish. SNOPT gets our functions and sparse slopes through
callbacks of Python; what these take is told apart. It has no second derivatives.
"""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import examples
from benchmarks.peers.installing import NotInstallable, python_of

PATIENCE = 150.0
"""Seconds for one example by SNOPT; twice as long, and the process is killed: it may not listen."""


@dataclass(frozen=True)
class Match:
    """An example, and how many steps."""

    example: str
    steps: int


MATCHES = (
    Match("stiction_block", 60),
    Match("finger_no_gravity", 24),
    Match("spring_flamingo", 20),
)

HEAD = (
    f"{'':28}{'objective':>12}{'iterations':>12}{'seconds':>10}{'callbacks':>11}{'x ours':>9}"
    f"{'without':>9}  status"
)


def main() -> None:
    """Print the table."""
    print("\nthe same contact-implicit programs by IPOPT, as ever, and by Drake's SNOPT")
    try:
        folder = _packages(python_of("drake"))
    except NotInstallable as why:
        print(f"Drake: not installable because: {why}")
        return
    print(HEAD)
    there = set(examples.names())
    for match in MATCHES:
        if match.example not in there:
            print(f"NOT MEASURED, not in the gallery: {match.example}")
            continue
        ours = _ask(match, "ipopt", folder)
        print(row(f"{match.example}, {match.steps}", ours, ours), flush=True)
        print(row("  SNOPT", _ask(match, "snopt", folder), ours), flush=True)


def _packages(python: Path) -> Path:
    """Where a virtual environment keeps what is installed."""
    (folder,) = (python.parents[1] / "lib").glob("python3*/site-packages")
    return folder


def _ask(match: Match, backend: str, folder: Path) -> dict[str, Any]:
    module = "benchmarks.peers.with_snopt"
    arguments = [match.example, str(match.steps), backend, str(PATIENCE), str(folder)]
    try:
        done = subprocess.run(  # noqa: S603 - our own command
            [sys.executable, "-W", "ignore", "-m", module, *arguments],
            capture_output=True,
            text=True,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
            check=False,
            timeout=2 * PATIENCE,
        )
    except subprocess.TimeoutExpired as late:
        passes = (late.stderr or b"").decode().splitlines()
        return {
            "status": f"no end within {2 * PATIENCE:g} s; passes: {', '.join(passes) or 'none'}"
        }
    if done.returncode:
        return {"status": (done.stderr.strip().splitlines() or ["no message"])[-1]}
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def row(label: str, told: dict[str, Any], ours: dict[str, Any]) -> str:
    """One line: ratios of all seconds, and of those without callbacks, to our seconds."""
    if "seconds" not in told:
        return f"{label:28}  {told['status']}"
    seconds, inside = told["seconds"], told["inside"]
    value = "-" if told["objective"] is None else f"{told['objective']:.6g}"
    ratios = [
        f"{one / ours['seconds']:9.1f}" if "seconds" in ours else f"{'-':>9}"
        for one in (seconds, seconds - inside)
    ]
    return (
        f"{label:28}{value:>12}{told['iterations']:12}{seconds:10.2f}{inside:11.2f}"
        f"{''.join(ratios)}  {told['status']}"
    )


if __name__ == "__main__":
    main()
