"""A real browser without a window: Chromium, driven over two pipes by its DevTools protocol, for tests and pictures."""

from __future__ import annotations

import json
import os
import select
import subprocess
import time
from base64 import b64decode
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--no-first-run",
    "--use-angle=swiftshader",  # WebGL on machines without a graphics card
    "--enable-unsafe-swiftshader",
    "--remote-debugging-pipe",
)
PATIENCE = 60.0  # s for an answer
CHUNK = 1 << 20  # bytes read at once
MODIFIERS = {"Shift": 8}
KEYS = {
    "ArrowLeft": 37,
    "ArrowUp": 38,
    "ArrowRight": 39,
    "ArrowDown": 40,
    "Enter": 13,
    "Escape": 27,
    "Tab": 9,
    " ": 32,
    "End": 35,
}
TEXTS = {"Enter": "\r", " ": " "}


class Browser:
    """One tab. What the console says and what the page asks the network for is kept.

    Raises:
        RuntimeError: a command or a script fails.
        TimeoutError: no answer comes.
    """

    def __init__(
        self, program: str, profile: Path, size: tuple[int, int] = (1000, 800), *, phone: bool = False
    ) -> None:
        commands, answers = os.pipe(), os.pipe()
        # Chromium takes commands from file descriptor 3 and answers on 4.
        start = f'exec "$@" 3<&{commands[0]} 4>&{answers[1]}'
        line = ["bash", "-c", start, "bash", program, *FLAGS, f"--user-data-dir={profile}", "about:blank"]
        passed = (commands[0], answers[1])
        self._process = subprocess.Popen(line, pass_fds=passed, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in passed:
            os.close(end)
        self._commands, self._answers = commands[1], answers[0]
        self._read, self._count, self._session = b"", 0, ""
        self.console: list[str] = []
        self.requests: list[str] = []
        self._loaded = False
        try:
            self._attach(*size, phone)
        except BaseException:
            self._end()
            raise

    def _attach(self, width: int, height: int, phone: bool) -> None:
        tab = self._call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=tab, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._call(f"{domain}.enable")
        screen = {"width": width, "height": height, "deviceScaleFactor": 2 if phone else 1, "mobile": phone}
        self._call("Emulation.setDeviceMetricsOverride", **screen)
        self._call("Emulation.setTouchEmulationEnabled", enabled=phone)

    def _end(self) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._commands)
        os.close(self._answers)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._session = ""
        try:
            self._call("Browser.close")
            self._process.wait(PATIENCE)
        finally:
            self._end()

    def open(self, page: Path) -> None:
        """Load a file and wait until it is there."""
        self._loaded = False
        self._call("Page.navigate", url=page.resolve().as_uri())
        end = time.monotonic() + PATIENCE
        while not self._loaded:
            self._event(end)

    def prefer(self, scheme: str) -> None:
        """Set the colour scheme: "light" or "dark"."""
        self._call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def run(self, script: str) -> Any:
        """The value of an expression, of what it promises if it promises something."""
        done = self._call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in done:
            raise RuntimeError(f"{script}: {done['exceptionDetails']['exception'].get('description')}")
        return done["result"].get("value")

    def middle_of(self, selector: str) -> tuple[float, float]:
        """Of an element, scrolled into the window, in pixels of it."""
        x, y = self.run(
            f"(e => {{ e.scrollIntoView({{block: 'center', behavior: 'instant'}});"
            "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2] })"
            f"(document.querySelector({json.dumps(selector)}))"
        )
        return x, y

    def click(self, selector: str) -> None:
        """Press and release the mouse over the middle of an element."""
        self.click_at(*self.middle_of(selector))

    def click_at(self, x: float, y: float) -> None:
        """Press and release the mouse at a place of the window."""
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y)

    def mouse(self, kind: str, x: float, y: float) -> None:
        """One event of the left button: mousePressed, mouseMoved or mouseReleased."""
        held = int(kind != "mouseReleased")
        self._call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=held, clickCount=1)

    def hover(self, x: float, y: float) -> None:
        """Move the mouse with no button pressed."""
        self._call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def touch(self, kind: str, places: Sequence[tuple[float, float]]) -> None:
        """One event of fingers: touchStart, touchMove or touchEnd."""
        points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(places)]
        self._call("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def press(self, key: str, *held: str) -> None:
        """Press and release a key."""
        modifiers = sum(MODIFIERS[name] for name in held)
        more: Mapping[str, Any] = {"text": TEXTS[key]} if key in TEXTS else {}
        for kind in ("keyDown", "keyUp"):
            code = KEYS[key]
            self._call(
                "Input.dispatchKeyEvent",
                type=kind,
                key=key,
                windowsVirtualKeyCode=code,
                modifiers=modifiers,
                **(more if kind == "keyDown" else {}),
            )

    def picture(self, selector: str | None = None) -> bytes:
        """PNG of the window, or of an element in it."""
        clip: dict[str, Any] = {}
        if selector is not None:
            self.middle_of(selector)
            x, y, width, height = self.run(
                "(b => [b.x + scrollX, b.y + scrollY, b.width, b.height])"
                f"(document.querySelector({json.dumps(selector)}).getBoundingClientRect())"
            )
            clip = {"clip": {"x": x, "y": y, "width": width, "height": height, "scale": 1}}
        # What was asked for is drawn in the next frame.
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return b64decode(self._call("Page.captureScreenshot", format="png", optimizeForSpeed=True, **clip)["data"])

    def _call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._commands, data) :]
        end = time.monotonic() + PATIENCE
        while True:
            answer = self._event(end)
            if answer.get("id") == self._count:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                result: dict[str, Any] = answer["result"]
                return result

    def _event(self, end: float) -> dict[str, Any]:
        """The next message; what it says of console, network and loading is kept."""
        while b"\0" not in self._read:
            ready, _, _ = select.select([self._answers], [], [], max(0.0, end - time.monotonic()))
            data = os.read(self._answers, CHUNK) if ready else b""
            if not data:
                raise TimeoutError(f"the browser does not answer; it ended with {self._process.poll()}")
            self._read += data
        text, _, self._read = self._read.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        told = message.get("params", {})
        match message.get("method"):
            case "Runtime.consoleAPICalled":
                self.console.append(" ".join(str(one.get("value", one.get("description"))) for one in told["args"]))
            case "Runtime.exceptionThrown":
                self.console.append(str(told["exceptionDetails"].get("exception", told)))
            case "Log.entryAdded":
                self.console.append(told["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requests.append(told["request"]["url"])
            case "Page.loadEventFired":
                self._loaded = True
        return message
