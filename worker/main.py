"""Starting a worker, and asking whether one lives."""

import gc
import logging
import socket
from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace

from schemas.errors import StoreUnavailable
from store import connect
from store.backend.connection import open_client
from store.backend.wiring import assemble
from store.ports import Store
from store.settings import LONG, NONE, SHORT, StoreSettings
from worker.attempt import Engines
from worker.presence import Presence, unique_name
from worker.process import FootfallWorker
from worker.run import RUNNER, Runner
from worker.settings import WorkerSettings

logger = logging.getLogger("footfall.worker")


def run_worker(
    settings: WorkerSettings,
    engines: Engines,
    *,
    backends: Sequence[str] = (),
    store_settings: StoreSettings | None = None,
) -> None:
    """Work until told to end: the first SIGTERM or SIGINT lets the job end, a second kills it.

    Everything that ``engines`` need is loaded by the caller, so that no fork loads it again.
    Call it in the main thread. Raises StoreUnavailable if the server stays away at the start.
    """
    settings = replace(settings, name=settings.name or unique_name())
    kept = store_settings or StoreSettings()
    client = open_client(settings.url, LONG)
    store = assemble(client, kept)
    glance = connect(settings.url, patience=NONE, settings=kept)
    _first_word(store, glance)
    RUNNER.set(Runner(store, glance, engines, settings.name))
    presence = Presence(store, settings.name, settings.ttl, backends)
    logger.info("worker %s starts", settings.name)
    gc.freeze()  # what is here already: a fork's collector would copy it page by page
    FootfallWorker(client, store, glance, settings, presence).work(logging_level="ERROR")
    logger.info("worker %s has ended", settings.name)


def _first_word(store: Store, glance: Store) -> None:
    """Wait for the server, and say at once that we do. Raises StoreUnavailable in the end."""
    try:
        glance.ping()
    except StoreUnavailable as error:
        logger.warning("no work yet: %s %s", error.message, error.hint)
        store.ping()


def check(url: str) -> tuple[bool, str]:
    """Whether a worker of this machine lives, and the words for an operator."""
    try:
        with closing(connect(url, patience=SHORT)) as store:
            store.ping()
            workers = store.queue.workers()
    except StoreUnavailable as error:
        return False, error.message
    here = [str(worker["name"]) for worker in workers if worker.get("host") == socket.gethostname()]
    if not here:
        return False, "no worker of this machine is alive"
    return True, f"alive: {', '.join(here)}"
