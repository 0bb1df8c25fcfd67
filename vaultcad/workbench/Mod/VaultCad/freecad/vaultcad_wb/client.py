"""The worker, a process in vaultcad's environment: started when asked, started anew when it died, gone with FreeCAD."""

from __future__ import annotations

import atexit
import contextlib
import itertools
import json
import os
import queue
import subprocess
import threading
import time
from collections import deque
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
INTERPRETER = HERE / "interpreter.txt"  # written by `vaultcad freecad install`
MODULE = "vaultcad.workbench.worker"
PATIENCE = 120.0  # [s] for what has no cancel button; the first request waits for slow imports
TOLD = 30  # lines of the worker's standard error that are kept


class RefusedError(Exception):
    """What was asked cannot be; the reason in one line."""


class GoneError(Exception):
    """The worker could not be started, or ended before it answered; one line."""


class Call:
    """One request under way."""

    def __init__(self, worker: Worker) -> None:
        self.worker = worker
        self.replies: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()

    def poll(self, timeout: float | None = 0.0) -> dict[str, Any] | None:
        """The next reply: "progress", "result", "error" or "gone"; None if there is none within `timeout` [s]."""
        try:
            return self.replies.get(block=timeout != 0, timeout=timeout or None)
        except queue.Empty:
            return None

    def result(self, timeout: float = PATIENCE) -> dict[str, Any]:
        """Wait for the result.

        Raises:
            RefusedError: the worker's reason.
            GoneError: the worker ended, or gave no answer in time and was ended.
        """
        end = time.monotonic() + timeout
        while True:
            reply = self.poll(max(0.001, end - time.monotonic()))
            if reply is None:
                self.worker.stop()
                raise GoneError(f"the worker gave no answer within {timeout:g} s and was ended")
            if "progress" not in reply:
                return outcome(reply)


def outcome(reply: dict[str, Any]) -> dict[str, Any]:
    """The result that a last reply holds.

    Raises:
        RefusedError, GoneError: it holds none.
    """
    if "error" in reply:
        raise RefusedError(reply["error"])
    if "gone" in reply:
        raise GoneError(reply["gone"])
    found: dict[str, Any] = reply["result"]
    return found


class Worker:
    """At most one process at a time."""

    def __init__(self, interpreter: str | None = None) -> None:
        self.interpreter = interpreter
        self._life: _Life | None = None
        atexit.register(self.stop)

    @property
    def pid(self) -> int | None:
        """Number of the process, None while there is none."""
        return self._life.process.pid if self._life is not None and self._life.process.poll() is None else None

    def ask(self, do: str, **arguments: Any) -> dict[str, Any]:
        """Send a request and wait for its result; see `Call.result`."""
        return self.begin(do, **arguments).result()

    def begin(self, do: str, **arguments: Any) -> Call:
        """Send a request; its replies come to the call.

        Raises:
            GoneError: the worker could not be started.
        """
        if self._life is None or self.pid is None:
            self._life = _Life(self.interpreter or _interpreter())
        call = Call(self)
        self._life.send(call, do, arguments)
        return call

    def stop(self) -> None:
        """End the process, whatever it is doing; calls under way are told."""
        if self._life is not None:
            self._life.end()


class _Life:
    """One process from its start to its end, with the calls that it is to answer."""

    def __init__(self, interpreter: str) -> None:
        # Of FreeCAD's environment nothing may reach another Python: bundles set these for their own libraries.
        env = {name: value for name, value in os.environ.items() if name not in {"LD_LIBRARY_PATH", "QT_PLUGIN_PATH"}}
        pipe = subprocess.PIPE
        command = [interpreter, "-I", "-m", MODULE]  # -I: PYTHONPATH and PYTHONHOME are FreeCAD's too
        try:
            self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, env=env)
        except OSError as error:
            why = f"{interpreter} cannot be started ({error.strerror}); run `vaultcad freecad install` again"
            raise GoneError(why) from None
        self._calls: dict[int, Call] = {}
        self._numbers = itertools.count(1)
        self._lock = threading.Lock()
        self._ended = ""
        self._said: deque[str] = deque(maxlen=TOLD)
        self._errors = threading.Thread(target=self._drain, daemon=True)
        self._errors.start()
        self._replies = threading.Thread(target=self._listen, daemon=True)
        self._replies.start()

    def end(self) -> None:
        """Kill the process, and wait until all calls are told."""
        self.process.kill()
        self._replies.join(5.0)

    def send(self, call: Call, do: str, arguments: dict[str, Any]) -> None:
        """Send a request whose replies go to a call."""
        number = next(self._numbers)
        with self._lock:
            if self._ended:
                call.replies.put({"gone": self._ended})
                return
            self._calls[number] = call
        stream: Any = self.process.stdin
        with contextlib.suppress(OSError):  # it died this moment: the listener tells all calls
            stream.write(json.dumps({"id": number, "do": do, **arguments}).encode() + b"\n")
            stream.flush()

    def _listen(self) -> None:
        stream: Any = self.process.stdout
        with stream:
            for line in stream:
                reply = json.loads(line)
                with self._lock:
                    find = self._calls.get if "progress" in reply else self._calls.pop
                    call = find(reply["id"])
                if call is not None:
                    call.replies.put(reply)
        code = self.process.wait()
        self._errors.join(1.0)
        requests: Any = self.process.stdin
        with contextlib.suppress(OSError):  # what it was still to be told is lost
            requests.close()
        with self._lock:
            self._ended = self._epitaph(code)
            calls = list(self._calls.values())
        for call in calls:
            call.replies.put({"gone": self._ended})

    def _drain(self) -> None:
        stream: Any = self.process.stderr
        with stream:
            for line in stream:
                if text := line.decode(errors="replace").strip():
                    self._said.append(text)

    def _epitaph(self, code: int) -> str:
        how = f"was killed by signal {-code}" if code < 0 else f"ended with code {code}"
        why = f" ({self._said[-1]})" if self._said and code > 0 else ""
        return f"the worker {how}{why}; the next edit starts a new one"


def _interpreter() -> str:
    try:
        return INTERPRETER.read_text(encoding="utf-8").strip()
    except OSError:
        raise GoneError(f"{INTERPRETER} is missing; run `vaultcad freecad install` again") from None


BUILDER = Worker()
"""Makes shapes and files."""
FITTER = Worker()
"""Reads and fits scans, so that vaults can be edited meanwhile."""
