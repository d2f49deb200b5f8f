"""The JSON Schema of a problem as it may be posted: with the names that the service replaces."""

from functools import cache
from typing import Any, Literal

from pydantic import Field

from schemas.base import Identifier, Posted
from schemas.problem import Problem
from schemas.values import Scalar

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


class LibrarySystem(Posted):
    """The system of an example's first phase, with some of its parameters replaced."""

    kind: Literal["library"]
    name: str = Field(description="As GET /v1/examples lists it.")
    parameters: dict[Identifier, Scalar] = Field(default_factory=dict)


class JobGuess(Posted):
    """The solution of a job of yours that has ended, from any method and mesh."""

    from_job: str = Field(description="The job's id.")


@cache
def problem_schema() -> dict[str, Any]:
    """JSON Schema (2020-12)."""
    schema = Problem.model_json_schema()
    definitions = schema["$defs"]
    for model in (LibrarySystem, JobGuess):
        definitions[model.__name__] = model.model_json_schema()
    system = definitions["Phase"]["properties"]["system"]
    library = f"#/$defs/{LibrarySystem.__name__}"
    system["oneOf"].append({"$ref": library})
    system["discriminator"]["mapping"]["library"] = library
    job = {"$ref": f"#/$defs/{JobGuess.__name__}"}
    definitions["Phase"]["properties"]["guess"]["anyOf"].append(job)
    guess = schema["properties"]["guess"]
    kinds = {name: guess.pop(name) for name in ("discriminator", "oneOf")}
    guess["anyOf"] = [kinds, job]
    return {"$schema": _DIALECT, **schema}
