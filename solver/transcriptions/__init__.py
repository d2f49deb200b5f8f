"""The transcriptions: one file each, listed here, made from the method's schema."""

from collections.abc import Mapping

from schemas.methods import Method
from solver.transcriptions.base import Transcription
from solver.transcriptions.chebyshev_lobatto import ChebyshevLobatto
from solver.transcriptions.hermite_simpson import HermiteSimpson
from solver.transcriptions.multiple_shooting import MultipleShooting
from solver.transcriptions.radau import Radau
from solver.transcriptions.trapezoidal import Trapezoidal

TRANSCRIPTIONS: Mapping[str, type[Transcription]] = {
    "trapezoidal": Trapezoidal,
    "hermite_simpson": HermiteSimpson,
    "radau": Radau,
    "chebyshev_lobatto": ChebyshevLobatto,
    "multiple_shooting": MultipleShooting,
}
"""The method's kind -> its transcription; the schema's other fields are its arguments."""


def make_transcription(method: Method) -> Transcription:
    """The transcription that a problem asks for."""
    options = method.model_dump(exclude={"kind", "segments"})
    return TRANSCRIPTIONS[method.kind](**options)


__all__ = ["TRANSCRIPTIONS", "Transcription", "make_transcription"]
