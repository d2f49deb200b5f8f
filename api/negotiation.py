"""Which media type to answer with (RFC 9110, 12.5.1)."""


def choose(accept: str | None, offered: tuple[str, ...]) -> str | None:
    """The offered type the client likes best, the first among equals; None if it takes none."""
    ranges = _ranges(accept or "*/*") or [("*/*", 1.0)]
    liking = {kind: _quality(kind, ranges) for kind in offered}
    best = max(offered, key=lambda kind: liking[kind])
    return best if liking[best] > 0 else None


def _ranges(accept: str) -> list[tuple[str, float]]:
    found = []
    for entry in accept.lower().split(","):
        kind, *parameters = (part.strip() for part in entry.split(";"))
        if kind:
            given = (p.removeprefix("q=") for p in parameters if p.startswith("q="))
            found.append((kind, _number(next(given, "1"))))
    return found


def _quality(kind: str, ranges: list[tuple[str, float]]) -> float:
    """The most exact range that fits decides."""
    for wanted in (kind, kind.partition("/")[0] + "/*", "*/*"):
        for name, quality in ranges:
            if name == wanted:
                return quality
    return 0.0


def _number(text: str) -> float:
    """A weight that cannot be read counts as none given."""
    try:
        weight = float(text)
    except ValueError:
        return 1.0
    return weight if 0 <= weight <= 1 else 1.0
