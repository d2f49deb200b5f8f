"""Pages for people: the console, and a help text for each type of error."""

import inspect
from functools import cache
from importlib import resources
from typing import Annotated

from fastapi import APIRouter, Path, Response

from api.errors import TYPES, NoRoute
from api.openapi import errors, texts

router = APIRouter(tags=["pages"], default_response_class=Response)

CONSOLE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_FILES = {"console.js": "text/javascript", "console.css": "text/css"}


@router.get("/", responses=texts("text/html"))
async def get_console() -> Response:
    """The console: what is there, the latest jobs, and a form that posts an example."""
    headers = {"Content-Security-Policy": CONSOLE_POLICY, "Cache-Control": "no-cache"}
    return Response(_file("index.html"), headers=headers, media_type="text/html")


@router.get("/console/{name}", include_in_schema=False)
async def get_console_file(name: str) -> Response:
    """The console's script and style."""
    if name not in _FILES:
        raise NoRoute("Nothing is served at this path.")
    headers = {"Cache-Control": "no-cache"}
    return Response(_file(name), headers=headers, media_type=_FILES[name])


@router.get(
    "/problems/{code}",
    responses=errors(404, also=texts("text/plain")),
)
async def get_help(
    code: Annotated[str, Path(description="The end of an error's type.")],
) -> Response:
    """What a type of error means."""
    for cls, kind in TYPES.items():
        if kind.code == code:
            text = f"{kind.title} ({kind.code}, HTTP {kind.status})\n\n{inspect.getdoc(cls)}\n"
            return Response(text, media_type="text/plain")
    known = ", ".join(sorted(kind.code for kind in TYPES.values()))
    raise NoRoute("There is no such type of error.", f"There are: {known}.")


@cache
def _file(name: str) -> bytes:
    return (resources.files("api") / "console" / name).read_bytes()
