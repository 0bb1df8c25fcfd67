"""JSON lines: a request in, any number of progress lines and one result or error out.

    {"id": 7, "do": "build", "family": "groin", ...}
    {"id": 7, "progress": "fitting", "share": 0.4}
    {"id": 7, "result": {...}}   or   {"id": 7, "error": "one line that says what is wrong"}

Requests are served one after another. The end of the input ends the process at once, whatever it is doing: whoever
asked is gone. To cancel a request is to end the process.
"""

from __future__ import annotations

import json
import math
import os
import queue
import sys
import threading
from collections.abc import Callable, Mapping
from typing import IO, Any

from segmentation.errors import ReadError
from vaultcad.errors import VaultcadError

WRONG = (ValueError, OSError, ReadError, VaultcadError)  # what the asker can mend; anything else is a fault of ours
Number = int | float


class Request:
    """The arguments of one request, each asked for by name and type; `progress` tells the asker the stage
    and the share, 0 to 1, that is done.
    """

    def __init__(self, arguments: Mapping[str, Any], progress: Callable[[str, float], None]) -> None:
        self.arguments, self.progress = arguments, progress

    def text(self, name: str, default: str | None = None) -> str:
        """A text that is not empty."""
        value = self.arguments.get(name, default)
        if not isinstance(value, str) or not value:
            raise ValueError(f"{name} = {_short(value)} is no text; give one")
        return value

    def number(self, name: str, default: float | None = None) -> float:
        """A finite number."""
        return _number(name, self.arguments.get(name, default))

    def texts(self, name: str) -> dict[str, str]:
        """Texts by name; none if it is left out."""
        found = self.table(name)
        if not all(isinstance(value, str) for value in found.values()):
            raise ValueError(f"{name} = {_short(found)}: all its values must be texts")
        return found

    def numbers(self, name: str) -> dict[str, float]:
        """Finite numbers by name; none if it is left out."""
        return {key: _number(key, value) for key, value in self.table(name).items()}

    def table(self, name: str) -> dict[str, Any]:
        """An object of JSON; an empty one if it is left out."""
        value = self.arguments.get(name) or {}
        if not isinstance(value, dict):
            raise ValueError(f"{name} = {_short(value)} is no table of names and values")
        return value

    def tables(self, name: str) -> list[dict[str, Any]]:
        """A list of objects of JSON, at least one."""
        value = self.arguments.get(name)
        if not isinstance(value, list) or not value or not all(isinstance(item, dict) for item in value):
            raise ValueError(f"{name} = {_short(value)} is no list of tables; give at least one")
        return value


Handler = Callable[[Request], Mapping[str, Any]]


def serve(handlers: Mapping[str, Handler]) -> None:
    """Serve standard input until it ends. What libraries print goes to standard error, off the channel."""
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    # Not on `sys.stdin`, which processes that are forked close: they would wait for who reads it.
    heard = os.fdopen(os.dup(0), "rb")
    threading.Thread(target=_listen, args=(heard, lines), daemon=True).start()
    while True:
        answer(lines.get(), handlers, lambda reply: _send(channel, reply))


def answer(line: bytes, handlers: Mapping[str, Handler], send: Callable[[dict[str, Any]], None]) -> None:
    """Serve one line; whatever is wrong with it becomes an error of one line."""
    number: object = None
    try:
        asked = _decoded(line)
        number = asked.get("id")
        name = asked.get("do")
        if not isinstance(name, str) or name not in handlers:
            raise ValueError(f"cannot do {_short(name)}; there are {', '.join(handlers)}")
        request = Request(asked, lambda stage, share: send({"id": number, "progress": stage, "share": share}))
        send({"id": number, "result": handlers[name](request)})
    except WRONG as error:
        send({"id": number, "error": _line(str(error))})
    except MemoryError:
        send({"id": number, "error": "not enough memory; thin the scan or crop it to one bay"})
    except Exception as error:
        sys.excepthook(type(error), error, error.__traceback__)
        send({"id": number, "error": _line(f"error in vaultcad itself ({type(error).__name__}: {error})")})


def _listen(stream: IO[bytes], lines: queue.SimpleQueue[bytes]) -> None:
    for line in stream:
        if line.strip():
            lines.put(line)
    os._exit(0)


def _send(channel: IO[str], reply: dict[str, Any]) -> None:
    try:
        channel.write(json.dumps(reply, allow_nan=False) + "\n")
        channel.flush()
    except BrokenPipeError:
        os._exit(0)


def _decoded(line: bytes) -> dict[str, Any]:
    try:
        asked = json.loads(line)
    except ValueError as error:
        raise ValueError(f"the request is no JSON ({error})") from None
    if not isinstance(asked, dict):
        raise ValueError(f"the request {_short(asked)} is no JSON object")
    return asked


def _number(name: str, value: object) -> float:
    if not isinstance(value, Number) or isinstance(value, bool) or not math.isfinite(value):
        raise ValueError(f"{name} = {_short(value)} is no number; give one")
    return float(value)


def _short(value: object) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _line(text: str) -> str:
    return " ".join(text.split()) or "error without a message"
