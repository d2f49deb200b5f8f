"""The files of the repository, as git sees them."""

import ast
import subprocess
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("api", "worker", "store", "solver", "schemas", "examples", "sdk/footfall", "benchmarks")


@cache
def tracked() -> tuple[Path, ...]:
    """Every file that is committed, or would be by ``git add --all``."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    paths = sorted(ROOT / name for name in listing.split("\0") if name)
    return tuple(path for path in paths if path.is_file())


def modules(*rooms: str) -> list[Path]:
    """The Python files below the given folders (all rooms if none is given), without tests."""
    folders = [ROOT / room for room in rooms or ROOMS]
    return [
        path
        for path in tracked()
        if path.suffix == ".py" and any(path.is_relative_to(folder) for folder in folders)
    ]


def strings(path: Path) -> set[str]:
    """Every string constant of a Python file."""
    return {
        node.value
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
