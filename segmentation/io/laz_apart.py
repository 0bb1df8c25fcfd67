"""LAZ points, unpacked by a process of its own, so that no file can take this one down with it."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

MEMORY = 2 << 30  # bytes that the process may have
SECONDS, RATE = 10, 1 << 19  # s of processor time that it may take, and bytes of the file for one more
PIPE = 1 << 20  # bytes between the two


class DecoderError(Exception):
    """The process could not unpack the file, or died. The message says why."""


class ApartReader:
    """What laspy asks for points: `read_n_points`. Starts the process at the first of them."""

    def __init__(self, path: Path, header: Any, record: bytes, parts: list[str]) -> None:
        """With the file, its header as laspy has it, its laszip record, and the parts of points that are needed."""
        decoder = find_spec("lazrs")
        if decoder is None or decoder.origin is None:
            raise ImportError("lazrs is not installed")
        self.size = int(header.point_format.size)
        self._asked = json.dumps(
            {
                "path": str(path),
                "start": int(header.offset_to_point_data),
                "count": int(header.point_count),
                "size": self.size,
                "record": record.hex(),
                "parts": parts,
                "library": str(Path(decoder.origin).parent.parent),
                "memory": MEMORY,
                "seconds": SECONDS + path.stat().st_size // RATE,
            }
        )
        self._left = int(header.point_count)
        self._ahead: tuple[int, Future[bytearray]] | None = None
        self._thread = ThreadPoolExecutor(1)
        self._process: subprocess.Popen[bytes] | None = None
        self._said: IO[bytes] | None = None

    def read_n_points(self, n: int) -> bytearray:
        """The next n records, as they are packed in LAS; as many more are fetched meanwhile.

        Raises:
            DecoderError: there are fewer, or the process died.
        """
        if self._process is None:
            self._start()
        ahead, self._ahead = self._ahead, None
        if ahead is not None and ahead[0] != n:  # nobody asks so, but nothing may be lost
            raise ValueError(f"{n} points after {ahead[0]} were fetched")
        points = self._fetched(n) if ahead is None else ahead[1].result()
        self._left -= n
        if self._left > 0:
            following = min(n, self._left)
            self._ahead = following, self._thread.submit(self._fetched, following)
        return points

    def _fetched(self, n: int) -> bytearray:
        """The next n records from the process."""
        assert self._process is not None  # started
        assert self._process.stdout is not None  # as it was asked for
        points = bytearray(n * self.size)
        view = memoryview(points)
        while view:
            count = self._process.stdout.readinto(view)  # type: ignore[attr-defined]  # a raw file, as unbuffered
            if not count:
                raise DecoderError(self._why())
            view = view[count:]
        return points

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._thread.shutdown()  # its pipe has ended
            for file in (self._process.stdout, self._said):
                if file is not None:
                    file.close()
            self._process = None

    def _start(self) -> None:
        self._said = tempfile.TemporaryFile()  # noqa: SIM115  # closed in `close`
        script = Path(__file__).with_name("laz_decoder.py")
        self._process = subprocess.Popen(
            [sys.executable, "-I", "-S", "-B", str(script), self._asked],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=self._said,
            bufsize=0,
            close_fds=True,
        )
        if sys.platform == "linux" and self._process.stdout is not None:
            import fcntl

            with suppress(OSError):  # more than this user may have
                fcntl.fcntl(self._process.stdout.fileno(), fcntl.F_SETPIPE_SZ, PIPE)

    def _why(self) -> str:
        """Why the process ended."""
        assert self._process is not None
        assert self._said is not None
        code = self._process.wait()
        self._said.seek(0)
        text = self._said.read().decode("utf-8", errors="replace").strip()
        return text.splitlines()[-1][:200] if code == 1 and text else f"the decoder was stopped with code {code}"
