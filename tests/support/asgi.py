"""A blocking HTTP client of an app in this process, on one event loop that lives as long as it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
from anyio.from_thread import BlockingPortal, start_blocking_portal
from fastapi import FastAPI


class AppClient:
    """Sends requests straight into an app; an error that escapes the app is raised here."""

    def __init__(self, portal: BlockingPortal, client: httpx.AsyncClient) -> None:
        self._portal = portal
        self._client = client

    def request(self, method: str, url: str, **options: Any) -> httpx.Response:
        return self._portal.call(lambda: self._client.request(method, url, **options))

    def get(self, url: str, **options: Any) -> httpx.Response:
        return self.request("GET", url, **options)

    def post(self, url: str, **options: Any) -> httpx.Response:
        return self.request("POST", url, **options)

    def delete(self, url: str, **options: Any) -> httpx.Response:
        return self.request("DELETE", url, **options)


@contextmanager
def app_client(app: FastAPI, headers: dict[str, str] | None = None) -> Iterator[AppClient]:
    """A client of ``app``, its lifespan entered."""
    with start_blocking_portal() as portal:
        transport = httpx.ASGITransport(app)
        client = httpx.AsyncClient(transport=transport, base_url="http://footfall", headers=headers)
        with portal.wrap_async_context_manager(app.router.lifespan_context(app)):
            yield AppClient(portal, client)
        portal.call(client.aclose)
