"""Server-sent events: the lines of a stream into events (the WHATWG standard's rules)."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from footfall.errors import BadReply


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened to a job.

    ``type`` is "stage", "nlp_iteration", "mesh" or "state"; ``data`` holds its fields. ``id``
    resumes a stream after it, and is empty for events of an in-process solve.
    """

    type: str
    data: dict[str, Any]
    id: str = ""

    @property
    def terminal(self) -> bool:
        """Whether the job has ended with this event."""
        return self.type == "state" and bool(self.data.get("terminal"))


def parse(lines: Iterable[str]) -> Iterator[Event]:
    """The events of a stream, given its lines without their ends.

    Comments and unknown fields are passed over, as is an event that was not finished by an empty
    line. Raises ``BadReply`` where the data is not a JSON object.
    """
    last_id, data = "", list[str]()
    for line in lines:
        if not line:
            if data:
                yield _event("\n".join(data), last_id)
            data = []
            continue
        name, _, value = line.partition(":")
        value = value.removeprefix(" ")
        if name == "data":
            data.append(value)
        elif name == "id" and "\0" not in value:
            last_id = value


def _event(data: str, event_id: str) -> Event:
    try:
        document = json.loads(data)
        return Event(str(document["type"]), document, event_id)
    except (json.JSONDecodeError, KeyError, TypeError) as error:
        raise BadReply(f"The service sent an event that cannot be read: {data[:200]}") from error
