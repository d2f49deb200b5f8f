"""The ``footfall`` command."""

from footfall.cli.main import main

__all__ = ["main"]
