"""The page around its sections: style, scripts, and the policy that lets in nothing else."""

from base64 import b64encode
from collections.abc import Sequence
from hashlib import sha256

from footfall.report.animation import motion_data
from footfall.report.drawing import pointer_data, script_json
from footfall.report.figures import Figure
from footfall.report.markup import Markup, asset, el, join, void
from footfall.report.motion import Motion


def document(
    title: str, body: Markup, figures: Sequence[Figure], motion: Motion | None = None
) -> str:
    """The whole page; its scripts read the figures under the pointer, and play the motion."""
    style = asset("figure.css") + asset("page.css")
    scripts = [asset("page.js"), *([asset("motion.js")] if motion else [])]
    policy = (
        f"default-src 'none'; style-src {_hash(style)}; "
        f"script-src {' '.join(map(_hash, scripts))}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
    head = el(
        "head",
        void("meta", charset="utf-8"),
        void("meta", http_equiv="Content-Security-Policy", content=policy),
        void("meta", name="viewport", content="width=device-width, initial-scale=1"),
        void("meta", name="color-scheme", content="light dark"),
        void("link", rel="icon", href="data:,"),
        el("title", f"{title} \N{MIDDLE DOT} Footfall"),
        el("style", Markup(style)),
    )
    data = [
        _data("figures", script_json([pointer_data(figure) for figure in figures])),
        *([_data("motion", script_json(motion_data(motion)))] if motion else []),
    ]
    run = join(*data, *(el("script", Markup(script)) for script in scripts))
    return f"<!doctype html>\n{el('html', head, el('body', body, run), lang='en')}\n"


def _data(name: str, json: Markup) -> Markup:
    return el("script", json, type="application/json", id=name)


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
