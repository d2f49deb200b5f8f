"""What an expression's author is told when it cannot be read or evaluated."""


class ExpressionError(ValueError):
    """The reason, the place (``column``, from 1, in the user's own text) and the mend."""

    def __init__(self, message: str, column: int, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.column = column
        self.hint = hint


def quoted(text: str) -> str:
    """``text`` in quotes, shortened and in printable ASCII, fit for a message."""
    short = text if len(text) <= 60 else text[:57] + "..."
    return ascii(short)
