"""Small builders of trees that fold numbers, zeros and ones; vectors of the plane as pairs."""

import math

from schemas.expressions import Call, Expression, Name, Number, Tree

ZERO, ONE = Number(0.0), Number(1.0)

Vec = tuple[Tree, Tree]

ORIGIN: Vec = (ZERO, ZERO)


def plus(*terms: Tree) -> Tree:
    """A sum without zeros; its numbers are one."""
    kept: list[Tree] = [term for term in terms if not isinstance(term, Number)]
    constant = sum(term.value for term in terms if isinstance(term, Number))
    if constant:
        kept.append(Number(constant))
    if not kept:
        return ZERO
    if len(kept) == 2 and _negative(kept[1]):
        return Call("-", (kept[0], minus(kept[1])))
    if len(kept) == 2 and _negative(kept[0]):
        return Call("-", (kept[1], minus(kept[0])))
    return kept[0] if len(kept) == 1 else Call("+", tuple(kept))


def _negative(tree: Tree) -> bool:
    return isinstance(tree, Call) and tree.function == "neg"


def minus(tree: Tree) -> Tree:
    """The negative."""
    if isinstance(tree, Number):
        return Number(-tree.value) if tree.value else ZERO
    if isinstance(tree, Call) and tree.function == "neg":
        return tree.arguments[0]
    if isinstance(tree, Call) and tree.function == "-":
        return Call("-", tree.arguments[::-1])
    return Call("neg", (tree,))


def less(a: Tree, b: Tree) -> Tree:
    """The difference ``a - b``."""
    return plus(a, minus(b))


def times(*factors: Tree) -> Tree:
    """A product without ones; its number is in front, its sign outside."""
    size, kept = 1.0, list[Tree]()
    for factor in factors:
        if factor is ZERO:
            return ZERO
        negative = isinstance(factor, Call) and factor.function == "neg"
        plain = factor.arguments[0] if isinstance(factor, Call) and negative else factor
        size = -size if negative else size
        if isinstance(plain, Number):
            size *= plain.value
        else:
            kept.append(plain)
    if size == 0 or not kept:
        return Number(size) if size else ZERO
    if size == -1:
        return minus(_product(kept))
    return _product(kept if size == 1 else [Number(size), *kept])


def _product(factors: list[Tree]) -> Tree:
    return factors[0] if len(factors) == 1 else Call("*", tuple(factors))


def over(a: Tree, b: Tree) -> Tree:
    """The quotient; of numbers their value."""
    if a == ZERO or b == ONE:
        return a
    if isinstance(a, Number) and isinstance(b, Number) and b.value:
        return Number(a.value / b.value)
    return Call("/", (a, b))


def square(tree: Tree) -> Tree:
    """The square, as a product where that is a name."""
    if isinstance(tree, Number):
        return Number(tree.value**2)
    return Call("*", (tree, tree)) if isinstance(tree, Name) else Call("^", (tree, Number(2.0)))


def call(function: str, *arguments: Tree) -> Tree:
    """A function; of ``sin``, ``cos`` and ``sqrt`` of numbers the value."""
    only = arguments[0]
    known = function in ("sin", "cos", "sqrt") and isinstance(only, Number)
    if isinstance(only, Number) and known and (function != "sqrt" or only.value >= 0):
        return Number(getattr(math, function)(only.value))
    return Call(function, arguments)


def vector(pair: list[Expression]) -> Vec:
    """What a user wrote as x and y."""
    return pair[0].tree, pair[1].tree


def both(a: Vec, b: Vec) -> Vec:
    """The sum of two vectors."""
    return plus(a[0], b[0]), plus(a[1], b[1])


def apart(a: Vec, b: Vec) -> Vec:
    """The difference of two vectors."""
    return less(a[0], b[0]), less(a[1], b[1])


def scaled(size: Tree, a: Vec) -> Vec:
    """A vector times a number."""
    return times(size, a[0]), times(size, a[1])


def dot(a: Vec, b: Vec) -> Tree:
    """The scalar product."""
    return plus(times(a[0], b[0]), times(a[1], b[1]))


def cross(a: Vec, b: Vec) -> Tree:
    """The third component of the vector product."""
    return less(times(a[0], b[1]), times(a[1], b[0]))


def turned(cos_sin: Vec, a: Vec) -> Vec:
    """A vector turned counterclockwise by an angle, of which cosine and sine are given."""
    c, s = cos_sin
    return less(times(c, a[0]), times(s, a[1])), plus(times(s, a[0]), times(c, a[1]))


def unit(a: Vec) -> Vec:
    """A vector of length one; numbers are divided at once."""
    if isinstance(a[0], Number) and isinstance(a[1], Number):
        length: Tree = Number(math.hypot(a[0].value, a[1].value))
    else:
        length = Call("hypot", a)
    return over(a[0], length), over(a[1], length)
