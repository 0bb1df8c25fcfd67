"""What an engine is told and what it answers, by files in a folder; imports nothing that a peer's Python may lack.

Each engine is a module that calls `serve` with its function and runs as `python -m bench.peers.NAME FOLDER`. It exits
with `MISSING` and one line on standard error where its library is not installed.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

CLOUD, JOB, LABELS, ANSWER = "cloud.ply", "job.json", "labels.npy", "answer.json"
MISSING = 3


@dataclass
class Job:
    """The settings of Schnabel, Wahl and Klein, and the cloud: float32 points and normals in `folder`/cloud.ply.

    `seconds` is what `timed` measures: from the cloud in memory to the shapes found; `cpu` the processor's seconds for
    it. `peak` [bytes] is the largest resident memory of the process that finds them, the cloud included.
    """

    folder: str
    epsilon: float
    beta: float
    min_points: int
    alpha_deg: float
    probability: float
    primitives: list[str]
    automatic: bool = False
    seconds: float = field(default=0.0, kw_only=True)
    cpu: float = field(default=0.0, kw_only=True)
    peak: int = field(default=0, kw_only=True)

    @property
    def cloud(self) -> Path:
        """The file of points."""
        return Path(self.folder) / CLOUD

    def write(self) -> None:
        """Leave the job in its folder."""
        (Path(self.folder) / JOB).write_text(json.dumps(asdict(self)), encoding="utf-8")

    def points(self) -> tuple[Any, Any]:
        """Points and normals, (n, 3) float32 each."""
        _, _, body = self.cloud.read_bytes().partition(b"end_header\n")
        table = np.frombuffer(body, dtype="<f4").reshape(-1, 6)
        return np.ascontiguousarray(table[:, :3]), np.ascontiguousarray(table[:, 3:])

    @contextmanager
    def timed(self) -> Iterator[None]:
        """Wall clock and processor time of what stands inside, and the peak memory at its end."""
        start, busy = time.perf_counter(), time.process_time()
        yield
        self.seconds, self.cpu, self.peak = time.perf_counter() - start, time.process_time() - busy, peak_memory()


def write_points(path: Path, xyz: Any, normals: Any) -> None:
    """The cloud as every engine reads it: binary PLY, x y z nx ny nz as float32."""
    names = ("x", "y", "z", "nx", "ny", "nz")
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(xyz)}\n"
    head += "".join(f"property float {name}\n" for name in names) + "end_header\n"
    path.write_bytes(head.encode() + np.hstack((xyz, normals)).astype("<f4").tobytes())


def peak_memory(process: int | str = "self") -> int:
    """Largest resident memory [bytes] of a process since it started; 0 where it has gone."""
    return memory("VmHWM", process)


def processor_time(process: int) -> float:
    """Seconds that a running process has had of the processor; 0 where it has gone."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory(name: str, process: int | str = "self") -> int:
    """A figure [bytes] of /proc/PROCESS/status, such as VmRSS; 0 where there is none."""
    try:
        lines = Path(f"/proc/{process}/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return 0
    return sum(1024 * int(line.split()[1]) for line in lines if line.startswith(name))


def serve(segment: Callable[[Job], Any]) -> None:
    """Read the job of the folder that the command line names, do it, leave labels (n,) and figures there."""
    folder = Path(sys.argv[1])
    job = Job(**json.loads((folder / JOB).read_text(encoding="utf-8")))
    try:
        labels = segment(job)
    except (ImportError, FileNotFoundError) as error:
        print(error, file=sys.stderr)
        sys.exit(MISSING)
    np.save(folder / LABELS, np.asarray(labels, dtype=np.int64))
    (folder / ANSWER).write_text(
        json.dumps({"seconds": job.seconds, "cpu": job.cpu, "peak": job.peak}), encoding="utf-8"
    )
