"""Logs for an operator: one line an event, as text or JSON, whatever users put into it."""

import json
import logging
import sys
import time

_CONTROL = {code: f"\\x{code:02x}" for code in (*range(32), *range(127, 160), 0x2028, 0x2029)}
_CONTROL |= {ord("\n"): "\\n", ord("\r"): "\\r", ord("\t"): "\\t"}


class TextLine(logging.Formatter):
    """``2026-01-31T12:00:00Z INFO footfall.worker: words``; newlines are escaped."""

    def __init__(self) -> None:
        super().__init__("%(asctime)s %(levelname)s %(name)s: %(message)s", "%Y-%m-%dT%H:%M:%SZ")
        self.converter = time.gmtime

    def format(self, record: logging.LogRecord) -> str:
        """The record on one line."""
        return super().format(record).translate(_CONTROL)


class JsonLine(logging.Formatter):
    """One JSON object a line: time (seconds since the epoch), level, logger, message, trace."""

    def format(self, record: logging.LogRecord) -> str:
        """The record on one line."""
        told = {
            "time": round(record.created, 3),
            "level": record.levelname,
            "logger": record.name,
            "message": record.getMessage(),
        }
        if record.exc_info:
            told["trace"] = self.formatException(record.exc_info)
        return json.dumps(told)


def configure(*, as_json: bool = False) -> None:
    """Log to stderr; of RQ only errors, since we tell of its deaths ourselves."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonLine() if as_json else TextLine())
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
    logging.getLogger("rq").setLevel(logging.ERROR)
