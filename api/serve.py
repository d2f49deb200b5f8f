"""Serving the app until a signal comes."""

import logging
import time
from dataclasses import replace

import uvicorn

from api.app import create_app
from api.settings import LOOPBACK_NAMES, ApiSettings
from store.ports import Store

_GRACE = 5
"""Seconds that open streams get at the end; their clients resume with the next process."""


def serve(store: Store, settings: ApiSettings) -> None:
    """Serve until SIGINT or SIGTERM.

    Raises
    ------
    SettingsError
        If the settings are unsafe; see ``ApiSettings.checked``.
    """
    safe = settings.checked()
    if safe.hosts is None and not safe.keys and not safe.open:
        safe = replace(safe, hosts=LOOPBACK_NAMES | {safe.host})
    uvicorn.run(
        create_app(store, safe),
        host=safe.host,
        port=safe.port,
        access_log=False,
        server_header=False,
        log_config=None,
        timeout_graceful_shutdown=_GRACE,
    )


def log_to_stderr() -> None:
    """One line for each event, on stderr. For processes whose whole purpose is to serve."""
    words, time_of_day = "%(asctime)s %(levelname)s %(name)s: %(message)s", "%Y-%m-%dT%H:%M:%SZ"
    formatter = logging.Formatter(words, time_of_day)
    formatter.converter = time.gmtime
    handler = logging.StreamHandler()
    handler.setFormatter(formatter)
    logging.basicConfig(level=logging.INFO, handlers=[handler])
