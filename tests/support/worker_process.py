"""``python -m tests.support.worker_process URL TTL ENGINE NAME``: a worker with short times."""

import sys

from store.settings import StoreSettings
from tests.support import engines
from worker import logs
from worker.attempt import Engines
from worker.main import run_worker
from worker.settings import WorkerSettings


def main(url: str, ttl: str, engine: str, name: str) -> None:
    settings = WorkerSettings(
        url=url, name=name, ttl=float(ttl), maintenance=float(ttl) / 3, tick=0.1, kill_after=0.5
    )
    logs.configure()
    run_worker(settings, _engines(engine), store_settings=StoreSettings())


def _engines(name: str) -> Engines:
    if name:
        return engines.ENGINES
    from footfall.report import render  # noqa: PLC0415 - the others need no engine
    from solver import solve  # noqa: PLC0415
    from solver.simulation import simulate  # noqa: PLC0415

    return Engines(solve, simulate, render)


if __name__ == "__main__":
    main(*sys.argv[1:])
