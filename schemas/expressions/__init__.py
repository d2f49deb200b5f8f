"""Expressions: text, checked by a whitelist over Python's grammar, into a typed tree.

``parse`` makes the tree, ``fold`` evaluates it over any arithmetic (floats, numpy, CasADi),
``constant`` over floats with the place of every error; ``Expression`` is the pydantic field.
Nothing here evaluates user text as code.
"""

from schemas.expressions.constant import constant
from schemas.expressions.errors import ExpressionError
from schemas.expressions.field import Expression
from schemas.expressions.fold import fold
from schemas.expressions.names import derivative, split, stem
from schemas.expressions.parser import parse
from schemas.expressions.smoothness import warnings_in
from schemas.expressions.tree import FUNCTIONS, OPERATORS, Call, Name, Number, Tree, names_in, walk

__all__ = [
    "FUNCTIONS",
    "OPERATORS",
    "Call",
    "Expression",
    "ExpressionError",
    "Name",
    "Number",
    "Tree",
    "constant",
    "derivative",
    "fold",
    "names_in",
    "parse",
    "split",
    "stem",
    "walk",
    "warnings_in",
]
