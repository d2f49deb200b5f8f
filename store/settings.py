"""What a store may be told. Given as parameters; nothing here reads the environment."""

from dataclasses import dataclass

DAY = 86_400.0


@dataclass(frozen=True, slots=True, kw_only=True)
class StoreSettings:
    """Limits and times of a store.

    Parameters
    ----------
    retention
        Seconds for which a result is kept after its job ended.
    memory
        Seconds for which the record of an ended job is kept; longer than ``retention``.
    queue_limit
        Jobs that may wait.
    events_limit
        Events that one job's log holds; the oldest go first.
    outer_net
        Seconds that RQ grants over a job's own budget. Only a net: inside IPOPT its alarm is lost.
    """

    retention: float = 7 * DAY
    memory: float = 30 * DAY
    queue_limit: int = 1000
    events_limit: int = 5000
    outer_net: float = 30.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Patience:
    """How long to wait for a server that is away, in seconds, before StoreUnavailable.

    ``silence``: try again also where the server took the command and did not reply.
    """

    tries: int
    first_pause: float
    longest_pause: float
    reply: float
    silence: bool = False


SHORT = Patience(tries=3, first_pause=0.05, longest_pause=0.5, reply=5.0)
"""For requests: somebody waits for the answer."""

LONG = Patience(tries=60, first_pause=0.2, longest_pause=2.0, reply=15.0, silence=True)
"""For workers: an hour of work hangs on it. A blocking read must be shorter than ``reply``."""

NONE = Patience(tries=0, first_pause=0.0, longest_pause=0.0, reply=1.0)
"""For what may be dropped: progress, and the glance at the cancel flag."""
