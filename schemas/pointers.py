"""JSON pointers (RFC 6901)."""

Part = str | int


def pointer(*parts: Part) -> str:
    """The pointer that leads through ``parts``; no parts point at the whole document."""
    return "".join("/" + str(part).replace("~", "~0").replace("/", "~1") for part in parts)


def parts_of(place: str) -> list[str]:
    """The parts of a pointer, as texts: indices too."""
    return [part.replace("~1", "/").replace("~0", "~") for part in place.split("/")[1:]]
