"""The OpenAPI document: FastAPI's own, with our errors and the posted models put in."""

from collections.abc import Callable
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from api.problems import MEDIA_TYPE, ProblemDetail

_REF = "#/components/schemas/"
Responses = dict[int | str, dict[str, Any]]


def errors(*statuses: int, also: Responses | None = None) -> Responses:
    """The error replies of a route, for its ``responses``; ``also`` are others to list."""
    content = {MEDIA_TYPE: {"schema": {"$ref": f"{_REF}{ProblemDetail.__name__}"}}}
    phrases = {status: HTTPStatus(status).phrase for status in statuses}
    listed: Responses = {
        status: {"description": phrase, "content": content} for status, phrase in phrases.items()
    }
    return listed | (also or {})


def texts(*media_types: str) -> Responses:
    """A 200 reply that is not JSON, for a route's ``responses``."""
    text = {"schema": {"type": "string"}}
    return {200: {"content": dict.fromkeys(media_types, text)}}


def request_body(model: str, *, required: bool = True) -> dict[str, Any]:
    """The body of a route that reads its bytes by itself, for its ``openapi_extra``."""
    schema = {"schema": {"$ref": f"{_REF}{model}"}}
    return {"requestBody": {"required": required, "content": {"application/json": schema}}}


def document(app: FastAPI, models: list[type[BaseModel]]) -> Callable[[], dict[str, Any]]:
    """What ``app.openapi`` should be; made on the first call. ``models`` are put in by name."""

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            whole = get_openapi(
                title=app.title,
                version=app.version,
                summary=app.summary,
                description=app.description,
                routes=app.routes,
            )
            whole["components"]["schemas"] |= _schemas(models)
            _mend(whole)
            app.openapi_schema = whole
        return app.openapi_schema

    return openapi


def _mend(whole: dict[str, Any]) -> None:
    """Say what FastAPI cannot know: its 422 looks like our errors, and keys may be off."""
    for methods in whole["paths"].values():
        for call in methods.values():
            replies = call["responses"]
            if "application/json" in replies.get("422", {}).get("content", {}):
                replies["422"] = errors(422)[422]
            if "security" in call:
                call["security"] = [{}, *call["security"]]
    for name in ("HTTPValidationError", "ValidationError"):
        whole["components"]["schemas"].pop(name, None)


def _schemas(models: list[type[BaseModel]]) -> dict[str, Any]:
    _, definitions = models_json_schema(
        [(model, "validation") for model in models], ref_template=_REF + "{model}"
    )
    schemas: dict[str, Any] = definitions["$defs"]
    return schemas
