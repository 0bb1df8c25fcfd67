"""CloudCompare's RANSAC Shape Detection, by its command line without a window.

The time is that between the lines with which the plugin begins and ends; loading and saving are not in it.
"""

from __future__ import annotations

import os
import pty
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np

from bench.peers.job import Job, peak_memory, processor_time, serve
from segmentation.io import read

PROGRAMS = ("CloudCompare", "cloudcompare.CloudCompare")
BEGINS = "ENABLE_PRIMITIVE"  # the last option, which it repeats before it starts
ENDS = ("[qRansacSD] Input cloud", "[SAVING]", "Processed finished")


def segment(job: Job) -> Any:
    """Labels (n,) by the job's settings, in the order of the clouds it saves."""
    program = next((found for name in PROGRAMS if (found := shutil.which(name))), None)
    if program is None:
        raise FileNotFoundError("no program CloudCompare: on Debian, apt-get install cloudcompare")
    clouds = Path(job.folder) / "clouds"
    shutil.rmtree(clouds, ignore_errors=True)
    options: dict[str, list[Any]] = {
        "EPSILON_ABSOLUTE": [job.epsilon],
        "BITMAP_EPSILON_ABSOLUTE": [job.beta],
        "SUPPORT_POINTS": [job.min_points],
        "MAX_NORMAL_DEV": [job.alpha_deg],
        "PROBABILITY": [job.probability],
        "OUT_CLOUD_DIR": [clouds],
        "OUTPUT_INDIVIDUAL_SUBCLOUDS": [],
        BEGINS: [kind.upper() for kind in job.primitives],
    }
    command = f"{program} -SILENT -NO_TIMESTAMP -AUTO_SAVE OFF -C_EXPORT_FMT PLY -O {job.cloud} -RANSAC".split()
    for name, values in options.items():
        command += [name, *map(str, values)]
    _watch(job, command)
    xyz, _ = job.points()
    labels = np.zeros(len(xyz), dtype=np.int64)
    order = np.argsort(_keys(xyz))
    known = _keys(xyz)[order]
    for number, path in enumerate(sorted(clouds.glob("*.ply")), start=1):
        saved = _keys(np.asarray(read(path).xyz, dtype=np.float32))
        labels[order[np.searchsorted(known, saved)]] = number
    return labels


def _watch(job: Job, command: list[str]) -> None:
    """Run it under a terminal, or else it would hold its lines back; the job gets time and memory."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    with subprocess.Popen(command, stdout=theirs, stderr=theirs, env=environment) as process:
        os.close(theirs)
        began = ended = (time.perf_counter(), 0.0)
        with os.fdopen(ours, errors="replace") as lines:
            try:
                for line in lines:
                    now = time.perf_counter(), processor_time(process.pid)
                    job.peak = max(job.peak, peak_memory(process.pid))
                    if BEGINS in line:
                        began = ended = now
                    elif ended == began and any(end in line for end in ENDS):
                        ended = now
            except OSError:  # how a terminal tells that its other end is closed
                pass
    job.seconds, job.cpu = ended[0] - began[0], ended[1] - began[1]


def _keys(xyz: Any) -> Any:
    """One comparable value (n,) for each point (n, 3) float32: its bytes."""
    return np.ascontiguousarray(xyz).view("V12").ravel()


if __name__ == "__main__":
    serve(segment)
