"""A process without enough memory says so; it does not call the problem infeasible."""

import subprocess
import sys

import pytest

PROGRAM = """
import resource
import examples
from schemas.reading import read_problem
from solver import solve

problem = examples.load("cart_pole")
solve(read_problem(problem))  # warm, as a worker is: OpenBLAS without room for its buffers spins
problem |= {"refinement": None, "limits": {"seconds": 20}}
problem["method"] = {"kind": "hermite_simpson", "segments": 5000}
checked = read_problem(problem)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (%d << 20), resource.RLIM_INFINITY))
try:
    print(solve(checked).status)
except MemoryError as error:
    print("memory:", error)
"""


@pytest.mark.parametrize("megabytes", [30, 80, 150])
def test_too_little_memory_is_not_infeasibility(megabytes: int) -> None:
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM % megabytes], capture_output=True, text=True, check=True
    )
    assert "memory:" in run.stdout, run.stdout + run.stderr
