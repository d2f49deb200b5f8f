"""From the model to the program and back: what all transcriptions share."""

from solver.transcribe.extract import extract
from solver.transcribe.transcribe import Transcribed, transcribe

__all__ = ["Transcribed", "extract", "transcribe"]
