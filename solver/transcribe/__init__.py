"""From the model to the program and back: what all transcriptions share."""

from solver.transcribe.costates import with_costates
from solver.transcribe.extract import Extracted, extract
from solver.transcribe.transcribe import Setting, Transcribed, transcribe

__all__ = ["Extracted", "Setting", "Transcribed", "extract", "transcribe", "with_costates"]
