"""Schedules of modes as phases: what a user says of one phase, said of each mode and between them.

Only the problem's trees change: any transcription solves what comes out, and the certificate
judges it. Periodic phases get the linkages that they stand for.
"""

from solver.hybrid.blame import as_posted
from solver.hybrid.expand import Expansion, Split, expand
from solver.hybrid.guess import mode_guesses
from solver.hybrid.sequence import mode_sequence

__all__ = ["Expansion", "Split", "as_posted", "expand", "mode_guesses", "mode_sequence"]
