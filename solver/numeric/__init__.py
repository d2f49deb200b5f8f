"""The problem's expressions and the published curves in numpy, independent of the NLP.

Shared by the certificate and the mesh error, over the forms of ``solver.lowering``; imports no
casadi.
"""

from solver.numeric.curves import MalformedCurves, PhaseCurves, Samples
from solver.numeric.phase import Along, along, departure, dynamics, evaluate, flow, named
from solver.numeric.quadrature import Integral, gauss, integrate
from solver.numeric.tape import Array

__all__ = [
    "Along",
    "Array",
    "Integral",
    "MalformedCurves",
    "PhaseCurves",
    "Samples",
    "along",
    "departure",
    "dynamics",
    "evaluate",
    "flow",
    "gauss",
    "integrate",
    "named",
]
