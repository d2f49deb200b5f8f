"""Middleware: what is refused before a route sees it. Plain ASGI, no buffering."""

import asyncio
from contextlib import suppress

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.errors import SlowBody, WrongHost
from api.problems import problem_response
from api.settings import ApiSettings
from schemas.errors import BodyTooLarge

_DRAIN = 8
"""An oversized body is read on and thrown away up to so many times the cap: a client that still
sends would otherwise meet a reset connection and never the 413."""


class HostGuard:
    """Serves only the names the settings list, which keeps rebound DNS names of web pages out."""

    def __init__(self, app: ASGIApp, settings: ApiSettings) -> None:
        self._app = app
        self._hosts = settings.hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what names this service, refuse the rest."""
        if self._hosts is None or scope["type"] != "http" or _host(scope) in self._hosts:
            await self._app(scope, receive, send)
            return
        names = ", ".join(sorted(self._hosts))
        refusal = problem_response(
            WrongHost("The Host header names another host.", f"Use {names}.")
        )
        await refusal(scope, receive, send)


def _host(scope: Scope) -> str:
    """The host's name, without the port and the brackets of an IPv6 address."""
    name = Headers(scope=scope).get("host", "")
    if name.startswith("["):
        return name[1:].partition("]")[0]
    return name.partition(":")[0].lower()


class HeadAsGet:
    """Answers HEAD wherever there is a GET: the same headers, no body, and no waiting for one."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a HEAD on as a GET and keep its body back."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self._app(scope, receive, send)
            return

        async def bodiless(message: Message) -> None:
            if message["type"] == "http.response.start":
                await send(message)
                await send({"type": "http.response.body", "body": b"", "more_body": False})

        scope["method"] = "GET"
        await self._app(scope, receive, bodiless)


class BodyGuard:
    """Counts the bytes of a body as they come, whatever its Content-Length says, and its time."""

    def __init__(self, app: ASGIApp, settings: ApiSettings) -> None:
        self._app = app
        self._cap = settings.body_bytes
        self._seconds = settings.body_seconds

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with a body that ends at the cap."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        declared = headers.get("content-length", "")
        counted = _Counted(receive, self._cap, self._seconds)
        if declared.isdecimal() and int(declared[:20]) > self._cap:
            if "expect" not in headers:  # else the client waits for our word before it sends
                await counted.drain()
            await problem_response(_too_large(self._cap))(scope, receive, send)
            return
        await self._app(scope, counted, send)


def _too_large(cap: int) -> BodyTooLarge:
    """The refusal, with the cap in words."""
    return BodyTooLarge(f"A body may have {cap:,} bytes.", "GET /v1/limits lists every limit.")


class _Counted:
    """A ``receive`` that refuses to pass on more than the cap, or to wait for ever."""

    def __init__(self, receive: Receive, cap: int, seconds: float) -> None:
        self._receive = receive
        self._cap = cap
        self._seconds = seconds
        self._seen = 0
        self._whole = False
        self._deadline: float | None = None

    async def __call__(self) -> Message:
        message = await self._next()
        if self._seen > self._cap:
            await self.drain()
            raise _too_large(self._cap)
        return message

    async def drain(self) -> None:
        """Read on, keeping nothing, until the body ends or is not worth it."""
        with suppress(SlowBody):
            while not self._whole and self._seen <= _DRAIN * self._cap:
                await self._next()

    async def _next(self) -> Message:
        if self._whole:  # what follows is the wait for a disconnect, which may last
            return await self._receive()
        now = asyncio.get_running_loop().time()
        self._deadline = self._deadline or now + self._seconds
        try:
            async with asyncio.timeout_at(self._deadline):
                message = await self._receive()
        except TimeoutError:
            raise SlowBody(f"The body took over {self._seconds:g} s.") from None
        self._seen += len(message.get("body", b""))
        self._whole = not message.get("more_body", False)
        return message
