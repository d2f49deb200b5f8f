"""What the operator may set. Read from the environment when asked, never at import."""

import ipaddress
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

N = TypeVar("N", bound=float)

LEAST_MEGABYTES = 256
"""A problem cannot ask for less (``schemas.problem.Limits``), so nor can a cap."""

LOOPBACK_NAMES = frozenset({"127.0.0.1", "localhost", "::1"})


class SettingsError(ValueError):
    """A setting is malformed, or the settings together are unsafe."""


@dataclass(frozen=True, slots=True)
class ApiSettings:
    """The settings of one api process.

    ``keys`` maps a bearer key to its owner; empty, everybody is the owner ``local``. ``hosts``
    are the names served, None for any. Seconds and megabytes cap what a problem may ask for.
    """

    host: str = "127.0.0.1"
    port: int = 8000
    redis_url: str = ""
    keys: Mapping[str, str] = field(default_factory=dict, repr=False)
    open: bool = False
    hosts: frozenset[str] | None = None
    body_bytes: int = 5_000_000
    body_seconds: float = 30.0
    max_seconds: float = 3600.0
    max_megabytes: int = 8192
    max_waiting_jobs: int = 500
    max_samples: int = 100_000
    stop_grace: float = 1.0

    @property
    def loopback(self) -> bool:
        """Whether only this machine can reach the address."""
        if self.host in LOOPBACK_NAMES:
            return True
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return False

    def checked(self) -> "ApiSettings":
        """These settings, if they are safe to serve with.

        Raises
        ------
        SettingsError
            Without keys, on an address that others can reach, unless that was said to be meant.
        """
        if self.keys or self.open or self.loopback:
            return self
        raise SettingsError(
            f"refusing to serve on {self.host} without keys: anybody who reaches it could use it. "
            "Set FOOTFALL_KEYS=owner:key,... , or FOOTFALL_OPEN=1 if something else guards it."
        )


def from_environment(environment: Mapping[str, str]) -> ApiSettings:
    """Settings out of ``FOOTFALL_...`` variables and ``REDIS_URL``; defaults for the rest.

    Raises
    ------
    SettingsError
        Names the variable, its value, and what was expected.
    """
    default = ApiSettings()
    return ApiSettings(
        host=environment.get("FOOTFALL_HOST", default.host),
        port=_number(environment, "FOOTFALL_PORT", default.port, 65_535),
        redis_url=environment.get("REDIS_URL", ""),
        keys=_keys(environment.get("FOOTFALL_KEYS", "")),
        open=_flag(environment, "FOOTFALL_OPEN"),
        body_bytes=_number(environment, "FOOTFALL_BODY_BYTES", default.body_bytes, 10**8),
        body_seconds=_number(environment, "FOOTFALL_BODY_SECONDS", default.body_seconds, 3600),
        max_seconds=_number(environment, "FOOTFALL_MAX_SECONDS", default.max_seconds, 86_400),
        max_megabytes=_number(
            environment, "FOOTFALL_MAX_MEGABYTES", default.max_megabytes, 10**6, LEAST_MEGABYTES
        ),
        max_waiting_jobs=_number(
            environment, "FOOTFALL_MAX_WAITING_JOBS", default.max_waiting_jobs, 10**6
        ),
        max_samples=_number(environment, "FOOTFALL_MAX_SAMPLES", default.max_samples, 10**7),
    )


def _number(environment: Mapping[str, str], name: str, default: N, top: int, least: int = 0) -> N:
    text = environment.get(name, "").strip()
    if not text:
        return default
    kind: type[N] = type(default)
    try:
        value = kind(text)
    except ValueError:
        value = kind(-1)
    if not (value > 0 and least <= value <= top):
        what = "a whole number" if kind is int else "a number"
        low = f"from {least}" if least else "above 0"
        raise SettingsError(f"{name} is {text!r}; expected {what} {low}, up to {top}")
    return value


def _flag(environment: Mapping[str, str], name: str) -> bool:
    text = environment.get(name, "").strip().lower()
    if text not in {"", "0", "1", "true", "false", "yes", "no"}:
        raise SettingsError(f"{name} is {text!r}; expected 1 or 0")
    return text in {"1", "true", "yes"}


def _keys(text: str) -> dict[str, str]:
    """``owner:key,owner:key`` as a table from key to owner. Never shows a key in an error."""
    keys: dict[str, str] = {}
    for position, entry in enumerate(filter(None, map(str.strip, text.split(","))), 1):
        owner, colon, key = entry.partition(":")
        if not colon or not re.fullmatch(r"[A-Za-z0-9_-]{1,64}", owner) or len(key) < 16:
            raise SettingsError(
                f"FOOTFALL_KEYS: entry {position} is not owner:key with a key of 16 characters "
                "or more (owner: letters, digits, _ and -)"
            )
        keys[key] = owner
    return keys
