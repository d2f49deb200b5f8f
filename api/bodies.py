"""Reading a JSON body as bytes; what is in it is the reader's business."""

from email.message import Message
from typing import Annotated

from fastapi import Depends, Request

from api.errors import UnsupportedMedia

_HINT = "Send it with 'Content-Type: application/json', in UTF-8 and uncompressed."


async def _json_body(request: Request) -> bytes:
    _check_declared(request)
    return await request.body()


async def _optional_json_body(request: Request) -> bytes:
    body = await request.body()
    if body:
        _check_declared(request)
    return body


def _check_declared(request: Request) -> None:
    declared = request.headers.get("content-type", "")
    message = Message()
    message["content-type"] = declared.replace("\r", "").replace("\n", "")
    if not declared or message.get_content_type() != "application/json":
        raise UnsupportedMedia(f"The body is declared as '{declared[:80]}'.", _HINT)
    charset = message.get_content_charset("utf-8")
    if charset not in ("utf-8", "utf8", "us-ascii"):
        raise UnsupportedMedia(f"The body is declared in '{charset[:40]}'.", _HINT)
    encoding = request.headers.get("content-encoding", "identity")
    if encoding.strip().lower() != "identity":
        raise UnsupportedMedia(f"The body is declared as '{encoding[:40]}'-encoded.", _HINT)


JsonBody = Annotated[bytes, Depends(_json_body)]
OptionalJsonBody = Annotated[bytes, Depends(_optional_json_body)]
