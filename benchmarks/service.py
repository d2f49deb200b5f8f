"""The cart-pole through HTTP, queue and a warm worker, against the engine in this process.

Run: python -m benchmarks.service
"""

import tempfile
import time
from pathlib import Path

import examples
from benchmarks.table import Row, in_turn, show, timed
from footfall import Client
from footfall.serving import ServeSettings, Service
from schemas.reading import read_problem
from solver import solve

RUNS = 20
PAUSE = 0.1
"""Seconds after a job: the worker still draws the report, and must not slow what comes next."""


def main() -> None:
    """Print the table."""
    document = examples.load("cart_pole")
    with (
        tempfile.TemporaryDirectory(prefix="footfall-") as folder,
        Service(ServeSettings(port=0, folder=Path(folder))) as service,
        Client(service.url) as client,
    ):

        def through_the_service() -> float:
            seconds = timed(lambda: client.wait(client.submit(document).id))
            time.sleep(PAUSE)
            return seconds

        def in_this_process() -> float:
            return timed(lambda: solve(read_problem(document)).model_dump_json())

        served, here = in_turn(RUNS, through_the_service, in_this_process)
    rows = [Row("HTTP, queue, warm worker, result fetched", served, here)]
    show("cart-pole refined to 1e-6, medians", rows, "in-process")
    print(f"on top of the engine: {(served - here) * 1e3:.0f} ms (aim: at most 60)")


if __name__ == "__main__":
    main()
