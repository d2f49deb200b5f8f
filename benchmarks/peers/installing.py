"""A virtual environment for each peer, made once and kept in a folder that git ignores."""

import shutil
import subprocess
import sys
import venv
from pathlib import Path

CACHE = Path(".footfall") / "peers"
REQUIREMENTS = Path(__file__).parent / "requirements"

_PATIENCE = 600.0  # seconds for one installation


class NotInstallable(Exception):
    """A peer cannot be had here; the message is what pip said last."""


def python_of(peer: str) -> Path:
    """The interpreter of a peer's environment, which is made if it is not there.

    Raises
    ------
    NotInstallable
        If pip cannot bring the pinned packages.
    """
    pinned = REQUIREMENTS / f"{peer}.txt"
    folder = (CACHE / peer).absolute()
    record, python = folder / "requirements.txt", folder / "bin" / "python"
    if record.exists() and record.read_text() == pinned.read_text():
        return python
    print(f"installing {peer} into {CACHE / peer} ...", file=sys.stderr)
    shutil.rmtree(folder, ignore_errors=True)
    venv.create(folder, with_pip=True)
    command: list[str | Path] = [
        python,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "-r",
        pinned,
    ]
    try:
        done = subprocess.run(  # noqa: S603 - our own command
            command, check=False, capture_output=True, text=True, timeout=_PATIENCE
        )
    except subprocess.TimeoutExpired:
        raise NotInstallable(f"pip took more than {_PATIENCE:g} s") from None
    if done.returncode:
        raise NotInstallable((done.stderr.strip().splitlines() or ["pip failed"])[-1])
    record.write_text(pinned.read_text())
    return python
