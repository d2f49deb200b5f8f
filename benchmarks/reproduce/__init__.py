"""The seeds' tables from nothing: ``make reproduce`` solves all of them and writes a document.

``tables`` says what is solved (data), ``measure`` solves it, ``document`` writes it down.
``python -m benchmarks.reproduce.scenarios`` makes starts on the ice and chooses a phase sequence.
"""
