"""The mode sequence as a picture: a row for each contact and limit, the guess above the result.

What a contact does is seen by its place and height in the row, not by colour alone: sticking fills
it, sliding to the right and upper limits are the upper half, to the left and lower ones the lower.
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from footfall.modes import FREE, Mode, ModeSequence
from footfall.report.markup import Child, Markup, el, join
from footfall.report.scales import Scale, scientific
from footfall.summary import mode_words, plural, words

_NAME, _BAR, _OLD, _BETWEEN = 19, 16, 8, 9
"""Heights in px: of a row's name, of what was found, of what was guessed, and between rows."""

_SLIGHT = 0.35  # percent of the width: a kick of one short step is seen all the same
_LETTER = 0.9  # percent of the width that a digit takes
_MOST_LINES = 80  # changes; more of them are no help

_HALVES = {"sliding_right": 0.0, "upper": 0.0, "sliding_left": 0.5, "lower": 0.5}
"""Where the half of a bar begins, from its top."""

_COLOURS = {
    "sticking": "stick",
    "sliding_left": "left",
    "sliding_right": "right",
    "lower": "stop",
    "upper": "stop",
    "frictionless": "bare",
    "sliding": "right",
}
_SIGNS = {"sliding_left": "\N{LEFTWARDS ARROW}", "sliding_right": "\N{RIGHTWARDS ARROW}"}


class Sequences(NamedTuple):
    """What was found, and what was guessed before."""

    found: ModeSequence
    guessed: ModeSequence | None

    @property
    def axis(self) -> Scale:
        """The time from the first to the last mode of both, s."""
        modes = [*self.found.modes, *(self.guessed.modes if self.guessed else [])]
        start, end = min(mode.start for mode in modes), max(mode.end for mode in modes)
        return Scale(start, end if end > start else start + 1.0)

    @property
    def step(self) -> int:
        """From one row to the next, px."""
        return _NAME + _BAR + _BETWEEN + (_OLD + 2 if self.guessed else 0)


def sequences_of(result: Mapping[str, Any]) -> Sequences | None:
    """Those of a result; None where it has none, or nothing may touch."""
    found = result.get("mode_sequence")
    if not found or not found["modes"] or not found["contacts"]:
        return None
    guessed = result.get("guessed_sequence")
    before = ModeSequence.of(guessed) if guessed and guessed["modes"] else None
    return Sequences(ModeSequence.of(found), before)


def timeline(given: Sequences, **box: Child) -> tuple[Markup, int]:
    """The picture as an ``svg`` with the attributes of ``box``, and its height in px."""
    axis, names = given.axis, given.found.contacts
    height = len(names) * given.step + _NAME + _BAR + _BETWEEN
    rows = [_row(given, name, index * given.step) for index, name in enumerate(names)]
    drawn = el(
        "svg",
        _ticks(axis),
        _changes(given),
        *rows,
        _numbers(given, len(names) * given.step),
        overflow="visible",
        height=height,
        role="img",
        aria_label=f"What {', '.join(names)} do over time",
        **box,
    )
    return drawn, height


def keys(given: Sequences) -> list[tuple[str, Markup]]:
    """For the legend: every word that occurs, with a swatch of 22 by 12 px."""
    both = [given.found, *([given.guessed] if given.guessed else [])]
    seen = [word for one in both for mode in one.modes for word in mode.contacts.values()]
    order = [*_COLOURS, *seen]
    return [
        (words(word) if word not in ("lower", "upper") else f"at {word} limit", _swatch(word))
        for word in dict.fromkeys(sorted(seen, key=order.index))
    ]


def said(given: Sequences) -> str:
    """How many modes there are, in words."""
    found = given.found
    text = (
        f"{plural(found.distinct, 'distinct mode')} of {scientific(found.possible, 6)} possible "
        f"ones, {plural(len(found.transitions), 'change')} of contacts"
    )
    if given.guessed is None:
        return f"{text}."
    before = plural(given.guessed.distinct, "distinct mode")
    return f"{text}; thin bars above are the guess, with {before}."


def _row(given: Sequences, name: str, top: float) -> Markup:
    """One contact: its name, what was guessed, what was found."""
    top += _NAME
    parts: list[Markup] = [el("text", name, class_="tick start named", x=0, y=top - 5)]
    if given.guessed:
        parts += _bars(given.guessed, name, given.axis, (top, _OLD), "guessed")
        top += _OLD + 2
    parts += _bars(given.found, name, given.axis, (top, _BAR), "found")
    return el("g", *parts, class_="row", data_name=name)


def _bars(
    sequence: ModeSequence, name: str, axis: Scale, place: tuple[float, float], kind: str
) -> Iterator[Markup]:
    top, height = place
    first, last = sequence.modes[0].start, sequence.modes[-1].end
    start, end = (100 * float(axis.at(time)) for time in (first, last))
    yield el(
        "rect", class_="lane", x=_share(start), width=_share(end - start), y=top, height=height
    )
    for start, end, word in sequence.spans(name):
        if word != FREE:
            yield _bar(axis, (start, end), word, place, f"{kind}: {name}")


def _bar(
    axis: Scale, span: tuple[float, float], word: str, place: tuple[float, float], who: str
) -> Markup:
    left, right = (100 * float(axis.at(time)) for time in span)
    width = max(right - left, _SLIGHT)
    ends = " to ".join(scientific(time, 4) for time in span)
    bar = el(
        "rect",
        el("title", f"{who} {words(word)}, {ends} s"),
        class_=f"doing {_COLOURS.get(word, 'bare')}",
        x=_share(left),
        width=_share(width),
        **_half(word, *place),
    )
    sign = _SIGNS.get(word) if place[1] == _BAR and width > 3 * _LETTER else None
    if sign is None:
        return bar
    y = place[0] + (0.25 if _HALVES[word] else 0.75) * place[1]
    middle = _share(left + width / 2)
    return join(bar, el("text", sign, class_="sign", x=middle, y=y, dy="0.35em"))


def _half(word: str, top: float, height: float) -> dict[str, float]:
    """Where in a row's height a word is."""
    if word in _HALVES:
        return {"y": top + _HALVES[word] * height, "height": 0.5 * height}
    if word == "frictionless":
        return {"y": top + 0.3 * height, "height": 0.4 * height}
    return {"y": top, "height": height}


def _numbers(given: Sequences, top: float) -> Markup:
    """The modes themselves, each with the number of its kind, by its first appearance."""
    top += _NAME
    parts: list[Markup] = [el("text", "mode", class_="tick start named", x=0, y=top - 5)]
    sequence = given.found
    for index, (mode, number) in enumerate(zip(sequence.modes, sequence.numbers, strict=True)):
        parts.append(_numbered(mode, number, given.axis, top, index % 2))
    return el("g", *parts, class_="row modes")


def _numbered(mode: Mode, number: int, axis: Scale, top: float, shade: int) -> Markup:
    left, right = (100 * float(axis.at(time)) for time in (mode.start, mode.end))
    ends = " to ".join(scientific(time, 4) for time in (mode.start, mode.end))
    told = mode_words({"contacts": mode.contacts})
    bar = el(
        "rect",
        el("title", f"mode {number}: {told}, {ends} s"),
        class_=f"kind k{shade}",
        x=_share(left),
        width=_share(right - left),
        y=top,
        height=_BAR,
    )
    if right - left < _LETTER * (len(str(number)) + 1):
        return bar
    middle = _share((left + right) / 2)
    return join(bar, el("text", number, class_="count", x=middle, y=top + _BAR / 2, dy="0.35em"))


def _ticks(axis: Scale) -> Markup:
    found = [(_share(100 * place), label) for place, label in axis.ticks(10)]
    if found:
        found[-1] = (found[-1][0], f"{found[-1][1]} s")
    return join(
        el("line", class_="axis", x1="0", x2="100%", y1="100%", y2="100%"),
        *(el("line", class_="axis", x1=x, x2=x, y1="100%", y2="101.5%") for x, _ in found),
        *(el("text", label, class_="tick x", x=x, y="100%", dy="18") for x, label in found),
    )


def _changes(given: Sequences) -> Markup | None:
    """A faint line through all rows wherever the mode changes."""
    starts = [mode.start for mode in given.found.modes[1:]]
    if len(starts) > _MOST_LINES:
        return None
    places = [_share(100 * float(given.axis.at(start))) for start in starts]
    return join(*(el("line", class_="change", x1=x, x2=x, y1="0", y2="100%") for x in places))


def _swatch(word: str) -> Markup:
    lane = el("rect", class_="lane", width=22, height=12)
    bar = el("rect", class_=f"doing {_COLOURS.get(word, 'bare')}", width=22, **_half(word, 0, 12))
    return join(lane, bar)


def _share(percent: float) -> str:
    return f"{percent:.3f}%"
