"""Progress bars on standard error: only where it is a terminal, so that logs and pipes stay quiet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


class Status:
    """The bar of a piece of work that runs through named stages."""

    def __init__(self, progress: Progress, task: TaskID, stages: Sequence[str]) -> None:
        self._progress, self._task, self._stages = progress, task, stages

    def stage(self, name: str, detail: str = "") -> None:
        """A stage begins; one that is not among those announced leaves the bar where it is."""
        done = self._stages.index(name) if name in self._stages else None
        self._progress.update(self._task, description=f"{name} {detail}".strip(), completed=done)

    def share(self, done: float) -> None:
        """The share 0..1 of the present stage that is done."""
        at = int(self._progress.tasks[0].completed)
        self._progress.update(self._task, completed=at + min(done, 0.999))


@contextmanager
def status(stages: Sequence[str]) -> Iterator[Status]:
    """A bar for the work in the body, gone when it ends."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.description:<40}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        yield Status(progress, progress.add_task(stages[0], total=len(stages)), stages)
