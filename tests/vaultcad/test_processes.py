"""Work on all cores."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable

import pytest

from families import Barrel
from segmentation.errors import WriteError
from vaultcad import processes
from vaultcad.errors import ExportError
from vaultcad.find.no_vault import PartlyError
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.processes import beside, spread


def test_results_come_in_order_whatever_cannot_be_sent_to_a_process() -> None:
    local = {k: k * k for k in range(7)}
    assert list(spread(lambda k: local[k], 7)) == [k * k for k in range(7)]


def test_what_a_process_raises_is_raised_and_the_next_work_goes_on() -> None:
    def work(k: int) -> int:
        if k == 3:
            raise ValueError("three cannot be")
        return k

    with pytest.raises(ValueError, match="three cannot be"):
        list(spread(work, 5))
    assert list(spread(lambda k: k, 3)) == [0, 1, 2]


def test_a_refusal_comes_back_with_the_model_that_explains_some_of_it(caplog: pytest.LogCaptureFixture) -> None:
    model = Placed(Barrel(), Pose(0, 0, 3, 0))
    told = list(spread(lambda k: PartlyError(f"{k} % of it", model, 0.05), 3))
    assert [(str(one), one.placed, one.tolerance) for one in told] == [(f"{k} % of it", model, 0.05) for k in range(3)]
    assert not caplog.messages


def test_work_within_work_stays_in_its_process() -> None:
    inner = list(spread(lambda k: [os.getpid() == mine for mine in spread(lambda _: os.getpid(), 3)], 2))
    assert inner == [[True] * 3] * 2


def test_one_core_does_it_without_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "FORKS", False)
    assert list(spread(lambda k: os.getpid(), 2)) == [os.getpid()] * 2


def test_what_a_killed_process_left_is_done_here(caplog: pytest.LogCaptureFixture) -> None:
    here = os.getpid()

    def work(k: int) -> int:
        if k == 2 and os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return k * k

    assert list(spread(work, 6)) == [0, 1, 4, 9, 16, 25]
    (told,) = caplog.messages
    assert "killed" in told
    assert list(spread(lambda k: k, 3)) == [0, 1, 2]


def test_work_beside_has_work_beside_it() -> None:
    words: list[str] = []

    def further(tell: Callable[[str], None]) -> list[int]:
        tell("further")
        return [os.getpid()]

    def work(tell: Callable[[str], None]) -> list[int]:
        with beside(further) as result:
            tell("work")
            return [os.getpid(), *result(tell)]

    with beside(work) as result:
        there = result(words.append)
    assert words == ["work", "further"]
    assert len({os.getpid(), *there}) == (3 if processes.FORKS and len(os.sched_getaffinity(0)) > 1 else 1)


def test_work_beside_tells_its_way_and_what_it_came_to() -> None:
    words: list[str] = []
    here = os.getpid()

    def work(tell: Callable[[str], None]) -> int:
        tell("one")
        tell("two")
        return os.getpid()

    with beside(work) as result:
        there = result(words.append)
    assert words == ["one", "two"]
    assert there != here


@pytest.mark.parametrize("error", [WriteError("a.step", "disk full"), ExportError("no such body"), OSError(28, "full")])
def test_what_work_beside_raises_is_raised_here(error: Exception) -> None:
    def work(_: object) -> None:
        raise error

    with beside(work) as result, pytest.raises(type(error)) as raised:
        result(str)
    assert str(raised.value) == str(error)


def test_what_cannot_be_sent_is_told_in_words() -> None:
    def work(_: object) -> None:
        class LocalError(Exception):
            pass

        raise LocalError("of this function alone")

    with beside(work) as result, pytest.raises(RuntimeError, match="LocalError: of this function alone"):
        result(str)


def test_work_beside_that_was_killed_is_done_here(caplog: pytest.LogCaptureFixture) -> None:
    here = os.getpid()

    def work(_: object) -> int:
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return 7

    with beside(work) as result:
        assert result(str) == 7
    (told,) = caplog.messages
    assert "killed" in told


def test_nobody_waits_for_work_that_is_no_longer_wanted() -> None:
    with pytest.raises(ValueError, match="the scan cannot be packed"), beside(lambda _: time.sleep(3600)):
        raise ValueError("the scan cannot be packed")


def test_on_one_core_work_is_done_where_it_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "FORKS", False)
    with beside(lambda _: os.getpid()) as result:
        assert result(str) == os.getpid()
