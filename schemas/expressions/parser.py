"""Text to tree: tokens, then Python's own grammar, then a whitelist over its syntax tree.

Python's parser never meets the user's text. It gets a rendering of the tokens, with ``^`` as
``**`` and every name and number replaced by a placeholder, so that it settles precedence and
nothing else; the placeholders and the columns lead back to the user's text.
"""

import ast
import math

from schemas.expressions.build import function, operation
from schemas.expressions.errors import ExpressionError, quoted
from schemas.expressions.names import join_derivatives
from schemas.expressions.order import check_order
from schemas.expressions.tokens import MAX_DEPTH, MAX_NODES, TOO_LARGE, Token, tokenize
from schemas.expressions.tree import FUNCTIONS, Name, Number, Tree, depth, walk

_SYMBOLS: dict[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "**",
}


def parse(text: str) -> Tree:
    """Read an expression.

    Powers are ``^`` or ``**`` and bind as in mathematics: ``-x^2`` is ``-(x^2)``, ``a^b^c`` is
    ``a^(b^c)``. Constants are folded, sums and products are flat. An exponent may be any
    expression; a constant one is at most 64 in size. A derivative, ``final.dd(q)``, is one name.

    Raises
    ------
    ExpressionError
        With the message, the column in ``text`` and a hint.
    """
    tokens = tokenize(text)
    check_order(tokens)
    tree = _Reader(join_derivatives(tokens)).read()
    if sum(1 for _ in walk(tree)) > MAX_NODES:
        raise ExpressionError(f"more than {MAX_NODES} operations and values", 1, TOO_LARGE)
    if depth(tree) > MAX_DEPTH:
        raise _too_deep(1)
    return tree


class _Reader:
    """Reads one token list; holds the rendering and the way back from it."""

    def __init__(self, tokens: list[Token]) -> None:
        self.tokens = tokens
        pieces = [
            ("**" if token.text == "^" else token.text) if token.kind == "operator" else f"n{index}"
            for index, token in enumerate(tokens)
        ]
        self.source = "".join(pieces)
        self.columns = [
            token.column for token, piece in zip(tokens, pieces, strict=True) for _ in piece
        ]

    def read(self) -> Tree:
        try:
            body = ast.parse(self.source, mode="eval").body
        except (RecursionError, MemoryError):  # what Python's parser says of a long nest
            raise _too_deep(1) from None
        return self._node(body, 1)

    def _node(self, node: ast.expr, level: int) -> Tree:
        column = self.columns[node.col_offset]
        if level > MAX_DEPTH:
            raise _too_deep(column)
        match node:
            case ast.Name():
                tree = _leaf(self._token(node))
            case ast.UnaryOp(op=ast.UAdd()):
                tree = self._node(node.operand, level + 1)
            case ast.UnaryOp(op=ast.USub()):
                tree = operation("neg", [self._node(node.operand, level + 1)], column)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                tree = self._sum(node, level)
            case ast.BinOp(op=ast.Mult() | ast.Div()):
                tree = self._product(node, level)
            case ast.BinOp(op=ast.Pow()):
                sides = [self._node(side, level + 1) for side in (node.left, node.right)]
                tree = operation("^", sides, self._operator_column(node))
            case ast.Call(func=ast.Name() as callee, keywords=[]):
                arguments = [self._node(argument, level + 1) for argument in node.args]
                tree = function(self._token(callee).text, arguments, column)
            case _:
                raise ExpressionError("this is not part of the language", column)
        return tree

    def _sum(self, node: ast.BinOp, level: int) -> Tree:
        first, rest = self._spine(node, (ast.Add, ast.Sub))
        terms = [self._node(first, level + 1)]
        column = self._operator_column(node)
        for link in rest:
            column = self._operator_column(link)
            term = self._node(link.right, level + 1)
            if isinstance(link.op, ast.Add):
                terms.append(term)
            elif len(rest) == 1:
                return operation("-", [terms[0], term], column)
            else:
                terms.append(operation("neg", [term], column))
        return operation("+", terms, column)

    def _product(self, node: ast.BinOp, level: int) -> Tree:
        first, rest = self._spine(node, (ast.Mult, ast.Div))
        factors = [self._node(first, level + 1)]
        column = self._operator_column(node)
        for link in rest:
            column = self._operator_column(link)
            factor = self._node(link.right, level + 1)
            if isinstance(link.op, ast.Div):
                factors = [operation("/", [operation("*", factors, column), factor], column)]
            else:
                factors.append(factor)
        return operation("*", factors, column)

    def _spine(
        self, node: ast.expr, kinds: tuple[type[ast.operator], ...]
    ) -> tuple[ast.expr, list[ast.BinOp]]:
        """The first operand of a chain and its links in order, however long the chain."""
        links: list[ast.BinOp] = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, kinds):
            links.append(node)
            node = node.left
        return node, links[::-1]

    def _operator_column(self, node: ast.BinOp) -> int:
        place = self.source.index(_SYMBOLS[type(node.op)], node.left.end_col_offset)
        return self.columns[place]

    def _token(self, node: ast.Name) -> Token:
        return self.tokens[int(node.id[1:])]


def _leaf(token: Token) -> Tree:
    if token.kind == "number":
        return Number(float(token.text))
    if token.text == "pi":
        return Number(math.pi)
    if token.text in FUNCTIONS:
        raise ExpressionError(
            f"{quoted(token.text)} is a function", token.column, f"write {token.text}(...)"
        )
    return Name(token.text, token.column)


def _too_deep(column: int) -> ExpressionError:
    return ExpressionError(f"nested deeper than {MAX_DEPTH} levels", column, TOO_LARGE)
