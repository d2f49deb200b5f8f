"""Piecewise polynomials: what a result's ``curves`` are, and how they are made and evaluated.

A curve is one Chebyshev series per segment (first kind, argument s from -1 to 1 over the
segment). Everything is vectorised over times. Imports numpy only: engine, worker, service and
client all evaluate curves with this one file.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, Self

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Side = Literal["left", "right"]

_SLACK = 1e-9  # of the span: times that missed an end by rounding are moved onto it


class OutsideDomain(ValueError):
    """A time lies before the first or after the last break of a curve."""


class Curve:
    """One series over time.

    Parameters
    ----------
    breaks : array of shape (segments + 1,)
        Times in s, never decreasing.
    coefficients : array of shape (segments, degree + 1)
        Chebyshev coefficients of each segment, the constant first.

    Raises
    ------
    ValueError
        If the shapes do not fit, or a break lies before the one in front of it.
    """

    def __init__(self, breaks: ArrayLike, coefficients: ArrayLike) -> None:
        self.breaks = _checked_breaks(breaks)
        self.coefficients: Floats = np.asarray(coefficients, dtype=float)
        shape = self.coefficients.shape
        if len(shape) != 2 or shape[0] != len(self.breaks) - 1 or shape[1] == 0:
            raise ValueError(
                f"{len(self.breaks)} breaks need coefficients of shape "
                f"({len(self.breaks) - 1}, degree + 1), got {shape}."
            )

    @property
    def domain(self) -> tuple[float, float]:
        """The first and the last time, in s."""
        return float(self.breaks[0]), float(self.breaks[-1])

    @property
    def degree(self) -> int:
        """The degree of the polynomials."""
        return int(self.coefficients.shape[1]) - 1

    def __call__(self, time: ArrayLike, side: Side = "right") -> Any:
        """The values at ``time``, in the shape of ``time``.

        At a break, where a curve may jump, ``side`` says which segment counts; the first and the
        last time belong to the only segment there is. Raises ``OutsideDomain``.
        """
        segment, s = locate(self.breaks, time, side)
        rows = np.moveaxis(self.coefficients[segment], -1, 0)
        return chebyshev.chebval(s, rows, tensor=False)

    def derivative(self, order: int = 1) -> "Curve":
        """The time derivative; a segment of no width has the derivative zero."""
        width = np.diff(self.breaks)
        scale = np.divide(2.0, width, out=np.zeros_like(width), where=width > 0)
        slopes = chebyshev.chebder(self.coefficients, m=order, axis=1)
        return Curve(self.breaks, slopes * scale[:, None] ** order)

    def nodes(self, count: int) -> Floats:
        """``count`` times in each segment, ends included, denser near them; (segments, count).

        These are the Chebyshev points of the second kind, where a polynomial's extremes are seen
        best.
        """
        return self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * _unit_points(count)


class Curves(Mapping[str, Curve]):
    """Named curves over common breaks: one group of a result.

    Parameters
    ----------
    breaks : array of shape (segments + 1,)
        Times in s, never decreasing.
    coefficients : mapping of name to array of shape (segments, degree + 1)
        Chebyshev coefficients of each series.
    """

    def __init__(self, breaks: ArrayLike, coefficients: Mapping[str, ArrayLike]) -> None:
        self.breaks = _checked_breaks(breaks)
        self._curves = {name: Curve(self.breaks, rows) for name, rows in coefficients.items()}

    @classmethod
    def from_dict(cls, group: Mapping[str, Any]) -> Self:
        """Read a ``CurveGroup`` of a result's JSON."""
        return cls(group["breaks"], group["coefficients"])

    @classmethod
    def through(
        cls, names: Sequence[str], breaks: ArrayLike, nodes: ArrayLike, values: ArrayLike
    ) -> Self:
        """The polynomials through given values at given nodes of each segment.

        ``nodes`` are in [-1, 1]; ``values`` has shape (segments, nodes, series), the series in
        the order of ``names``. The degree is one less than the number of nodes.
        """
        return cls(breaks, dict(zip(names, fit(nodes, values), strict=True)))

    def to_dict(self) -> dict[str, Any]:
        """The ``CurveGroup`` as JSON values; null where a coefficient is not a finite number."""
        coefficients = {name: _listed(curve.coefficients) for name, curve in self.items()}
        return {"breaks": self.breaks.tolist(), "coefficients": coefficients}

    def sample(self, times: ArrayLike, side: Side = "right") -> dict[str, Floats]:
        """The values of every series at ``times``, by name."""
        return {name: curve(times, side) for name, curve in self.items()}

    def __getitem__(self, name: str) -> Curve:
        return self._curves[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._curves)

    def __len__(self) -> int:
        return len(self._curves)


def _listed(coefficients: Floats) -> list[list[float | None]]:
    rows = coefficients.tolist()
    return [[value if math.isfinite(value) else None for value in row] for row in rows]


def fit(nodes: ArrayLike, values: ArrayLike) -> Floats:
    """Chebyshev coefficients of the polynomials that pass through values at nodes, exactly.

    Parameters
    ----------
    nodes : array of shape (nodes,)
        Distinct points in [-1, 1].
    values : array of shape (segments, nodes, series)
        The values at the nodes of each segment.

    Returns
    -------
    array of shape (series, segments, nodes)
        ``fit(...)[i]`` are the coefficients of a ``Curve`` of series i.

    Raises
    ------
    ValueError
        If the shapes do not fit or two nodes are the same.
    """
    points = np.asarray(nodes, dtype=float)
    table = np.asarray(values, dtype=float)
    if points.ndim != 1 or table.ndim != 3 or table.shape[1] != len(points):
        raise ValueError(
            f"{points.shape} nodes need values of shape (segments, {points.size}, series), "
            f"got {table.shape}."
        )
    if len(np.unique(points)) != len(points):
        raise ValueError("The nodes must be distinct.")
    inverse = np.linalg.inv(chebyshev.chebvander(points, len(points) - 1))
    coefficients: Floats = np.einsum("jn,kni->ikj", inverse, table)
    return coefficients


def locate(
    breaks: Floats, time: ArrayLike, side: Side = "right"
) -> tuple[NDArray[np.intp], Floats]:
    """The segment of each time, and its place s in [-1, 1] there. Raises ``OutsideDomain``."""
    times = _inside(breaks, np.asarray(time, dtype=float))
    segment = np.clip(np.searchsorted(breaks, times, side=side) - 1, 0, len(breaks) - 2)
    width = breaks[segment + 1] - breaks[segment]
    share = np.divide(times - breaks[segment], width, out=np.ones_like(times), where=width > 0)
    return segment, 2.0 * share - 1.0


def _inside(breaks: Floats, times: Floats) -> Floats:
    first, last = float(breaks[0]), float(breaks[-1])
    slack = _SLACK * max(last - first, 1e-12)
    outside = ~((times >= first - slack) & (times <= last + slack))
    if np.any(outside):
        worst = float(times[outside].flat[0])
        raise OutsideDomain(f"t = {worst:g} s is outside of the curve's [{first:g}, {last:g}] s.")
    return np.clip(times, first, last)


def _checked_breaks(breaks: ArrayLike) -> Floats:
    checked = np.asarray(breaks, dtype=float)
    if checked.ndim != 1 or len(checked) < 2:
        raise ValueError(f"A curve needs at least two breaks, got shape {checked.shape}.")
    if not np.all(np.diff(checked) >= 0):
        raise ValueError("The breaks of a curve must be numbers that never decrease.")
    return checked


def _unit_points(count: int) -> Floats:
    if count < 2:
        raise ValueError(f"A segment has at least its two ends: count is {count}.")
    return (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2.0
