"""The outermost middleware: log line, metrics, security headers, and the net under all routes."""

import logging
import time
import uuid

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.errors import Bug
from api.metrics import Metrics
from api.problems import problem_response

logger = logging.getLogger("footfall.api")
access = logging.getLogger("footfall.access")

SECURITY_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
}


class Observer:
    """Watches every request from the outside."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and watch it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        answer = _Answer(send)
        start, method = time.monotonic(), scope["method"]
        try:
            await self._app(scope, receive, answer)
        except Exception as error:  # noqa: BLE001 - the net: no request may go unanswered
            await _apologize(scope, receive, answer, error)
        finally:
            self._report(scope, method, answer.status, time.monotonic() - start)

    def _report(self, scope: Scope, method: str, status: int, seconds: float) -> None:
        route = getattr(scope.get("route"), "path", "unknown")
        method = method if method in _METHODS else "other"
        self._metrics.answered(method, route, status, seconds)
        path = scope.get("raw_path", b"").decode("latin-1")[:200]
        client = (scope.get("client") or ("-", 0))[0]
        access.info("%s %s %s %d %.1f ms", client, method, ascii(path)[1:-1], status, seconds * 1e3)


_METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})


class _Answer:
    """A ``send`` that adds the security headers and remembers the status."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self.status = 0

    async def __call__(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            self.status = message["status"]
            headers = MutableHeaders(scope=message)
            for name, value in SECURITY_HEADERS.items():
                headers.setdefault(name, value)
        await self._send(message)


async def _apologize(scope: Scope, receive: Receive, answer: _Answer, error: Exception) -> None:
    number = uuid.uuid4().hex[:12]
    path = ascii(scope["path"])
    logger.error("bug %s in %s %s", number, scope["method"], path, exc_info=error)
    if answer.status == 0:
        bug = Bug(
            f"An unforeseen error; the service's log has it as {number}.", "Please report it."
        )
        await problem_response(bug)(scope, receive, answer)
