"""Footfall: trajectory optimization, also through contact, as a service or in this process.

>>> import footfall  # doctest: +SKIP
>>> result = footfall.solve("examples/cart_pole.json")  # doctest: +SKIP
>>> with footfall.Client("http://127.0.0.1:8000") as client:  # doctest: +SKIP
...     result = client.wait(client.submit("examples/cart_pole.json").id)

Names are loaded when they are first used, so that importing the package costs nothing.
"""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from footfall import errors
    from footfall.client import Client, Job
    from footfall.curves import Curve, Curves
    from footfall.local import simulate, solve
    from footfall.modes import ModeSequence
    from footfall.report import render, render_motion, render_svg
    from footfall.result import NodeValues, PhaseResult, Result, SimulationResult
    from footfall.sse import Event
    from footfall.sweeps import Sweep
    from footfall.transport import Retries

__all__ = [
    "Client",
    "Curve",
    "Curves",
    "Event",
    "Job",
    "ModeSequence",
    "NodeValues",
    "PhaseResult",
    "Result",
    "Retries",
    "SimulationResult",
    "Sweep",
    "errors",
    "render",
    "render_motion",
    "render_svg",
    "simulate",
    "solve",
]

_HOMES = {
    "Client": "client",
    "Curve": "curves",
    "Curves": "curves",
    "Event": "sse",
    "Job": "client",
    "ModeSequence": "modes",
    "NodeValues": "result",
    "PhaseResult": "result",
    "Result": "result",
    "Retries": "transport",
    "SimulationResult": "result",
    "Sweep": "sweeps",
    "render": "report",
    "render_motion": "report",
    "render_svg": "report",
    "simulate": "local",
    "solve": "local",
}


def __getattr__(name: str) -> Any:
    if name == "errors":
        return import_module("footfall.errors")
    if name == "__version__":
        return version("footfall")
    if name not in _HOMES:
        raise AttributeError(f"module 'footfall' has no attribute {name!r}")
    return getattr(import_module(f"footfall.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
