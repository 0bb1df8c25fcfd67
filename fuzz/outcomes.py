"""What becomes of a file that is read by a process of its own, with limits on time and memory."""

from __future__ import annotations

import multiprocessing
import os
import resource
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import numpy as np

from fuzz.mutants import mutant
from fuzz.pages import paged
from fuzz.samples import MAKERS, Sample
from segmentation import Cloud, ReadError, read
from segmentation.io.specks import far_specks

SECONDS = 10.0
MEMORY = 2 << 30
TURN = 1000  # mutants that a process reads: libE57 keeps 2 MB of each file whose packets break
SAME = 1e-6  # m; points no further apart are the same, nor are normals further apart
WARNING = {"damaged", "zeros", "unended", "unchecked", "dropped", "normals", "box", "specks"}
"""Codes of the notes by which people learn that points may be wrong; others say what is usual, as the unit taken."""
FATAL = ("abort", "hang", "traceback", "memory")


@dataclass
class Tally:
    """How many mutants came to which outcome, by the kind of damage; and examples (seed, kind, words) of each."""

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    examples: dict[str, list[tuple[int, str, str]]] = field(default_factory=dict)

    def add(self, outcome: str, seed: int, kind: str, words: str) -> None:
        """Take the outcome of a mutant."""
        self.counts[outcome, kind] += 1
        self.examples.setdefault(outcome, []).append((seed, kind, words))

    def number(self, *outcomes: str) -> int:
        """How many mutants came to one of these."""
        return sum(n for (outcome, _), n in self.counts.items() if outcome in outcomes)

    def kinds(self, outcome: str) -> dict[str, int]:
        """How many mutants of each kind came to an outcome."""
        return {kind: n for (found, kind), n in sorted(self.counts.items()) if found == outcome}


def tally(name: str, seeds: Iterable[int], folder: Path, kinds: tuple[str, ...] = (), workers: int = 0) -> Tally:
    """Read the mutants of a sample with these seeds, by as many processes as there are cores."""
    found = Tally()
    left = iter(seeds)
    running: dict[Any, _Worker] = {}
    try:
        for number in range(workers or min(4, os.cpu_count() or 1)):
            worker = _Worker(name, folder / str(number), kinds)
            if worker.give(left):
                running[worker.pipe] = worker
        while running:
            ready = wait(list(running), timeout=SECONDS / 20)
            for pipe in list(running):
                worker = running[pipe]
                if pipe not in ready and worker.waited() < SECONDS:
                    continue
                found.add(*worker.outcome(in_time=pipe in ready))
                del running[pipe]
                if worker.give(left):
                    running[worker.pipe] = worker
                else:
                    worker.end()
    finally:
        for worker in running.values():
            worker.end()
    return found


class _Worker:
    """A process that reads mutants, and comes again when one of them ends it."""

    def __init__(self, name: str, folder: Path, kinds: tuple[str, ...]) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.asked = (name, folder, kinds)
        self.seed = 0
        self._start()

    def _start(self) -> None:
        self.left = TURN
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, *self.asked), daemon=True)
        self.process.start()
        theirs.close()
        self.pipe.recv()  # ready: what it imports does not count

    def give(self, seeds: Iterator[int]) -> bool:
        """Hand over the next seed; whether there was one."""
        seed = next(seeds, None)
        if seed is None:
            return False
        self.seed = seed
        if self.left == 0:
            self.end()
            self._start()
        self.left -= 1
        self.begun = time.monotonic()
        self.pipe.send(seed)
        return True

    def waited(self) -> float:
        """Seconds since."""
        return time.monotonic() - self.begun

    def outcome(self, *, in_time: bool) -> tuple[str, int, str, str]:
        """Outcome, seed, kind and words of the mutant."""
        if in_time:
            try:
                outcome, kind, words = self.pipe.recv()
                return outcome, self.seed, kind, words
            except EOFError:
                self.process.join()
        name, _, kinds = self.asked
        kind, _ = mutant(_sample(name, self.asked[1]), self.seed, kinds)
        code = self.process.exitcode
        self.end()
        self._start()
        return ("abort", self.seed, kind, f"code {code}") if in_time else ("hang", self.seed, kind, "")

    def end(self) -> None:
        """End the process."""
        self.pipe.close()
        self.process.kill()
        self.process.join()


_SAMPLES: dict[str, Sample] = {}


def _sample(name: str, folder: Path) -> Sample:
    if name not in _SAMPLES:
        _SAMPLES[name] = MAKERS[name](folder)
    return _SAMPLES[name]


def _serve(pipe: Connection, name: str, folder: Path, kinds: tuple[str, ...]) -> None:
    """Read mutants of the sample as their seeds come in, and send what became of them."""
    warnings.simplefilter("error", RuntimeWarning)  # a word of numpy's own on a stranger's terminal is a fault
    sample = _sample(name, folder)
    path = folder / f"scan{sample.suffix}"
    path.write_bytes(good_file(sample))
    good = None if sample.is_empty else read(path)
    _compile()
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").exists() else 0
    most = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    pipe.send("ready")
    while True:
        try:
            seed = pipe.recv()
        except EOFError:
            return
        kind, data = mutant(sample, seed, kinds)
        path.write_bytes(data)
        outcome, words = _read(path, good)
        pipe.send((outcome, kind, words))


def _compile() -> None:
    """Have what is seldom called compiled, and loaded, before time and memory are limited."""
    points = np.random.default_rng(0).uniform(0, 1, (500, 3))
    points[0] = 1e3
    far_specks([points], [np.ones(500, np.bool_)], np.array([points.min(axis=0), points.max(axis=0)]))


def good_file(sample: Sample) -> bytes:
    """The sample as it is on disk."""
    return paged(sample.data) if sample.paged else sample.data


def _read(path: Path, good: Cloud | None) -> tuple[str, str]:
    """The outcome of reading a file, and what was said."""
    try:
        cloud = read(path)
    except ReadError as error:
        said = str(error)
        return "refused" if "\n" not in said and path.name in said else "traceback", said
    except MemoryError:
        return "memory", traceback.format_exc()
    except Exception:
        return "traceback", traceback.format_exc()
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    if most > MEMORY:
        return "memory", f"{most:,} bytes"
    usual = () if good is None else good.notes
    told = [note for note in cloud.notes if note.code in WARNING and note not in usual]
    if good is not None and _same(cloud, good):
        return "same", ""
    return "told" if told else "silent", "; ".join(note.text for note in told)


def _same(cloud: Cloud, good: Cloud) -> bool:
    """Whether both have the same points to the micrometre, with all that belongs to them, in any order."""
    mine, theirs = _table(cloud), _table(good)
    if mine.shape != theirs.shape:
        return False
    if np.allclose(mine, theirs, rtol=0, atol=SAME):
        return True
    mine, theirs = (rows[np.lexsort(rows.T)] for rows in (mine, theirs))
    return np.allclose(mine, theirs, rtol=0, atol=SAME)


def _table(cloud: Cloud) -> np.ndarray:
    """All numbers of the points, a row each; which of them there are stands in the last columns."""
    own = (cloud.normals, cloud.color, cloud.intensity, cloud.classification)
    there = [np.full(len(cloud), values is not None) for values in own]
    return np.column_stack([cloud.in_file(cloud.xyz), *(v for v in own if v is not None), *there]).astype(np.float64)
