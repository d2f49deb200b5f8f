"""``python -m api``: serve over the queue server at ``REDIS_URL``."""

import logging
import os
import sys
from contextlib import closing

from api.serve import log_to_stderr, serve
from api.settings import SettingsError, from_environment
from schemas.errors import StoreUnavailable
from store import connect

logger = logging.getLogger("footfall.api")


def main() -> int:
    """Exit code 0 after a signal, 2 for bad settings.

    A queue server that is away is no reason to end: ``/readyz`` tells of it until it is back.
    """
    log_to_stderr()
    try:
        settings = from_environment(os.environ).checked()
    except SettingsError as error:
        logger.critical("%s", error)
        return 2
    if not settings.redis_url:
        logger.critical("REDIS_URL is not set; for an embedded server use 'footfall serve'")
        return 2
    try:
        store = connect(settings.redis_url)
    except StoreUnavailable as error:
        logger.critical("%s %s", error.message, error.hint)
        return 2
    with closing(store):
        serve(store, settings)
    return 0


if __name__ == "__main__":
    sys.exit(main())
