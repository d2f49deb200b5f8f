"""Cursors of listings: opaque to clients, a time and an id to us."""

import base64
import binascii
from math import isfinite

from schemas.errors import BadProblem, Issue


def encode(created: float, job_id: str) -> str:
    """The cursor after this job."""
    return base64.urlsafe_b64encode(f"{created!r} {job_id}".encode()).decode().rstrip("=")


def decode(cursor: str) -> tuple[float, str]:
    """The job after which the listing goes on. Raises BadProblem."""
    try:
        padded = cursor + "=" * (-len(cursor) % 4)
        created, job_id = base64.urlsafe_b64decode(padded.encode()).decode().split(" ")
        if isfinite(float(created)):
            return float(created), job_id
    except (binascii.Error, ValueError):
        pass
    raise BadProblem(
        [Issue("/cursor", "This cursor is not one of ours.", "Take `next` of the last page.")]
    )
