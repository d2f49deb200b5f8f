"""The certificate: an independent judgement of a finished result.

It shares with what it judges the published curves and the problem's typed trees, lowered to
first-order form (``solver.lowering``, decision 009), and nothing else: numpy instead of casadi,
scipy's DOP853 instead of a collocation, an adaptive quadrature instead of the method's weights.
"""

from solver.certificate.certify import CHECKS, JUDGED, certify

__all__ = ["CHECKS", "JUDGED", "certify"]
