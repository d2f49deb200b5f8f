"""JSON Schemas of what may be posted: with the names that the service replaces."""

from functools import cache
from typing import Any

from schemas.base import Posted

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


@cache
def schema_of(model: type[Posted]) -> dict[str, Any]:
    """JSON Schema (2020-12)."""
    return {"$schema": _DIALECT, **model.model_json_schema()}
