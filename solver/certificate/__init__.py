"""The certificate: an independent judgement of a finished result.

It shares with what it judges the problem's typed text and the published curves, and nothing
else: numpy instead of casadi, scipy's DOP853 instead of a collocation, an adaptive quadrature
instead of the method's weights.
"""

from solver.certificate.certify import CHECKS, JUDGED, certify

__all__ = ["CHECKS", "JUDGED", "certify"]
