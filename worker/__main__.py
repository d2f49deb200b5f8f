"""``python -m worker``: work on the queue of ``REDIS_URL`` until told to end."""

import argparse
import os
import sys

from schemas.errors import FootfallError
from worker import logs
from worker.attempt import Engines
from worker.main import check, run_worker
from worker.settings import WorkerSettings, server_url
from worker.warming import warm_up


def main(arguments: list[str] | None = None) -> int:
    """Run a worker, or check for one; the exit code."""
    options = _parser().parse_args(arguments)
    url = options.url or server_url(os.environ)
    if options.check:
        alive, words = check(url)
        sys.stderr.write(words + "\n")
        return 0 if alive else 1
    logs.configure(as_json=options.json)
    # Read when numpy and casadi are loaded. A worker is one of as many as there are cores, and
    # the matrices are small: more threads would only wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        # Loaded here, once, so that --check is quick and no forked process loads it again.
        from footfall.report import render  # noqa: PLC0415
        from solver import solve  # noqa: PLC0415
        from solver.backends import BACKENDS  # noqa: PLC0415
        from solver.simulation import simulate  # noqa: PLC0415

        available = [name for name, backend in BACKENDS.items() if backend().available()]
        settings = WorkerSettings(url=url, name=options.name)
        engines = Engines(solve, simulate, render)
        warm_up(engines)
        run_worker(settings, engines, backends=available)
    except FootfallError as error:
        sys.stderr.write(f"{error.message} {error.hint}\n")
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m worker", description=__doc__)
    parser.add_argument("--url", default="", help="the queue server (default: REDIS_URL)")
    parser.add_argument("--name", default="", help="a unique name (default: made up)")
    parser.add_argument("--json", action="store_true", help="log JSON lines")
    parser.add_argument("--check", action="store_true", help="exit 0 if a worker lives here")
    return parser


if __name__ == "__main__":
    sys.exit(main())
