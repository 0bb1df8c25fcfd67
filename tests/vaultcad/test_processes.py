"""Work on all cores."""

from __future__ import annotations

import os
import signal

import pytest

from families import Barrel
from vaultcad import processes
from vaultcad.find.no_vault import PartlyError
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.processes import spread


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
