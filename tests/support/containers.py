"""The deployment as data: the compose file interpolated, and the Dockerfiles' instructions."""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).resolve().parents[2]
VARIABLE = re.compile(r"\$(?:\$|\{(\w+)(?:(:[-?])([^}]*))?\})")


class MissingVariable(ValueError):
    """A variable that the compose file insists on is not set."""


def interpolate(text: str, variables: Mapping[str, str]) -> str:
    """Fill ``${NAME}``, ``${NAME:-default}``, ``${NAME:?message}`` as compose does."""

    def value(match: re.Match[str]) -> str:
        name, operator, rest = match.groups()
        if name is None:
            return "$"
        if operator == ":?" and not variables.get(name):
            raise MissingVariable(f"{name}: {rest}")
        return variables.get(name) or (rest if operator == ":-" else "")

    return VARIABLE.sub(value, text)


def compose(variables: Mapping[str, str]) -> dict[str, Any]:
    """The compose file under the given variables."""

    def filled(node: Any) -> Any:
        if isinstance(node, dict):
            return {key: filled(item) for key, item in node.items()}
        if isinstance(node, list):
            return [filled(item) for item in node]
        return interpolate(node, variables) if isinstance(node, str) else node

    document: dict[str, Any] = filled(yaml.safe_load((ROOT / "docker-compose.yml").read_text()))
    return document


@dataclass(frozen=True)
class Dockerfile:
    """The instructions of a Dockerfile, in order, as (name, argument)."""

    instructions: tuple[tuple[str, str], ...]

    @classmethod
    def read(cls, path: Path) -> "Dockerfile":
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        joined = re.sub(r"\\\n\s*", "", "\n".join(lines))
        parts = [line.split(maxsplit=1) for line in joined.splitlines() if line.strip()]
        return cls(tuple((name.upper(), argument) for name, argument in parts))

    def all(self, name: str) -> list[str]:
        """The arguments of every instruction of that name."""
        return [argument for instruction, argument in self.instructions if instruction == name]

    @property
    def command(self) -> list[str]:
        """What runs; in exec form, or json refuses."""
        command: list[str] = json.loads(self.all("CMD")[-1])
        return command

    @property
    def health(self) -> list[str]:
        """The command of the health check."""
        command: list[str] = json.loads(self.all("HEALTHCHECK")[-1].partition("CMD ")[2])
        return command

    @property
    def environment(self) -> dict[str, str]:
        """The variables that the image sets."""
        pairs = [pair.partition("=") for text in self.all("ENV") for pair in shlex.split(text)]
        return {name: value for name, _, value in pairs}

    @property
    def copied(self) -> list[str]:
        """What is copied out of the repository."""
        return [
            source
            for text in self.all("COPY")
            if not text.startswith("--from")
            for source in text.split()[:-1]
        ]


def dockerfile(service: Mapping[str, Any]) -> Dockerfile:
    """The Dockerfile that builds a service's image."""
    return Dockerfile.read(ROOT / service["build"]["context"] / service["build"]["dockerfile"])
