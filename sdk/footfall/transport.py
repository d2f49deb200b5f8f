"""Requests that survive a bad moment: every error of httpx made ours, retries with patience."""

import json
import random
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

import httpx

from footfall.errors import (
    BadProblem,
    BadReply,
    Conflict,
    ConnectionFailed,
    FootfallError,
    Issue,
    TryLater,
    from_httpx,
    from_problem,
)

_FOREIGN = (httpx.HTTPError, httpx.InvalidURL, httpx.CookieConflict, httpx.StreamError)
_PROBLEM = "application/problem+json"


@dataclass(frozen=True, slots=True)
class Retries:
    """How often and how long to try again: ``tries`` more, pauses in s, doubling."""

    tries: int = 4
    first_pause: float = 0.2
    longest_pause: float = 20.0

    def pause(self, attempt: int, error: FootfallError) -> float:
        """Seconds before try number ``attempt`` + 1; what the service asks for, if it asks."""
        if isinstance(error, TryLater) and error.retry_after is not None:
            return min(error.retry_after, self.longest_pause)
        ceiling = min(self.first_pause * 2.0**attempt, self.longest_pause)
        return ceiling * random.uniform(0.5, 1.0)  # noqa: S311 - spreads clients, guards nothing


class Transport:
    """One httpx client; every request of ours may be repeated, so every one is retried."""

    def __init__(self, http: httpx.Client, retries: Retries) -> None:
        self.http = http
        self.retries = retries

    def request(self, method: str, path: str, **options: Any) -> httpx.Response:
        """Send, retry after lost connections, 429 and 503, and raise our errors."""
        for attempt in range(self.retries.tries):
            try:
                return self._once(method, path, **options)
            except (ConnectionFailed, TryLater, BadReply) as error:
                if isinstance(error, BadReply) and not _broke_off(error):
                    raise
                time.sleep(self.retries.pause(attempt, error))
        return self._once(method, path, **options)

    def json(self, method: str, path: str, **options: Any) -> Any:
        """The JSON of the reply."""
        return read_json(self.request(method, path, **options))

    def post_once(self, path: str, body: bytes, key: str | None) -> Any:
        """Post JSON under an idempotency key, made up unless given: again never makes a second.

        The JSON of the reply.
        """
        headers = {"Content-Type": "application/json", "Idempotency-Key": key or uuid.uuid4().hex}
        for attempt in range(self.retries.tries):
            try:
                return self.json("POST", path, content=body, headers=headers)
            except Conflict as error:  # a first try, whose answer was lost, is still at work
                time.sleep(self.retries.pause(attempt, error))
        return self.json("POST", path, content=body, headers=headers)

    @contextmanager
    def stream(self, path: str, **options: Any) -> Iterator[Iterator[str]]:
        """The lines of a reply as they come; no retries, since only the reader can resume."""
        with self._translated(), self.http.stream("GET", path, **options) as response:
            if response.is_error:
                response.read()
                raise self._refusal(response)
            yield response.iter_lines()

    def _once(self, method: str, path: str, **options: Any) -> httpx.Response:
        with self._translated():
            response = self.http.request(method, path, **options)
        if response.is_error:
            raise self._refusal(response)
        return response

    @contextmanager
    def _translated(self) -> Iterator[None]:
        try:
            yield
        except _FOREIGN as error:
            raise from_httpx(error, str(self.http.base_url)) from error

    def _refusal(self, response: httpx.Response) -> FootfallError:
        url = str(self.http.base_url)
        known = response.headers.get("Content-Type", "").startswith(_PROBLEM)
        error = from_problem(response.status_code, read_json(response) if known else {}, url)
        if response.status_code in {429, 503} and not isinstance(error, TryLater):
            error = TryLater(error.message, error.hint, status=response.status_code)
        if isinstance(error, TryLater):
            error.retry_after = retry_after(response.headers.get("Retry-After"))
        return error


def encoded(document: dict[str, Any]) -> bytes:
    """What is to be posted, as JSON. Raises ``BadProblem``."""
    try:
        return json.dumps(document, allow_nan=False).encode()
    except (TypeError, ValueError, RecursionError) as error:
        raise BadProblem([Issue("", f"The problem cannot be written as JSON: {error}")]) from error


def read_json(response: httpx.Response) -> Any:
    """The JSON of a reply. Raises ``BadReply`` where it is none."""
    try:
        return response.json()
    except ValueError as error:
        kind = response.headers.get("Content-Type", "no type")
        raise BadReply(
            f"{response.url} answered {response.status_code} with {kind} instead of JSON.",
            "Is this the address of a Footfall service?",
        ) from error


def retry_after(text: str | None) -> float | None:
    """Seconds out of a Retry-After header: a number, or a date of HTTP."""
    if text is None:
        return None
    if text.strip().isdecimal():
        return float(text)
    try:
        date = parsedate_to_datetime(text)
    except ValueError:
        return None
    return max(0.0, (date - datetime.now(UTC)).total_seconds())


def _broke_off(error: BadReply) -> bool:
    return isinstance(error.__cause__, httpx.RemoteProtocolError)
