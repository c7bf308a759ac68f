# SPDX-License-Identifier: GPL-2.0-only
"""Ctrl-C and SIGTERM: who hears them, and who has them afterwards."""

import os
import signal
import threading

import pytest
from mdanim_lammps.interrupts import Interrupts, on_signals
from mdanim_lammps.results.files import STOP
from mdanim_lammps.run.loop import _Stop

BOTH = (signal.SIGINT, signal.SIGTERM)


@pytest.fixture(autouse=True)
def as_before():
    """The test run has its handlers back, whatever a test does."""
    before = {number: signal.getsignal(number) for number in BOTH}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def send(number: signal.Signals) -> None:
    """A signal to this process, heard when this returns."""
    os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", BOTH)
def test_the_first_asks_and_later_ones_insist(number):
    """Whichever they are; afterwards they are again theirs who had them."""
    mine, told = lambda *_: told.append("mine"), []
    for each in BOTH:
        signal.signal(each, mine)
    with Interrupts(lambda: told.append("ask"), lambda: told.append("insist")) as heard:
        assert not heard.asked
        send(number)
        assert heard.asked
        for each in BOTH:
            send(each)
    assert told == ["ask", "insist", "insist"]
    for each in BOTH:
        send(each)
    assert told[3:] == ["mine", "mine"]


def test_ignored_signals_stay_ignored():
    """As those of a run that `nohup` or a shell's `trap ''` has begun."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with Interrupts(lambda: None, lambda: None) as heard:
        send(signal.SIGINT)
        assert not heard.asked and signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    on_signals(lambda *_: None)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_another_program_keeps_its_handlers():
    """A program may import this package; handlers of Python itself are replaced."""
    mine, ours = lambda *_: None, lambda *_: None
    signal.signal(signal.SIGINT, mine)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    on_signals(ours)
    assert [signal.getsignal(number) for number in BOTH] == [mine, ours]


def test_other_threads_leave_signals_alone(tmp_path):
    """Python allows handlers to the main thread only; a run in another one goes on without."""
    failed, before = [], [signal.getsignal(number) for number in BOTH]

    def work():
        try:
            on_signals(lambda *_: None)
            with Interrupts(lambda: None, lambda: None), _Stop(tmp_path) as stop:
                assert not stop.is_set()
                assert [signal.getsignal(number) for number in BOTH] == before
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert not failed


@pytest.mark.parametrize("number", BOTH)
def test_a_run_stops_after_its_frame_then_at_once(tmp_path, number):
    """The file ``stop`` asks as a signal does, and is gone afterwards."""
    with _Stop(tmp_path) as stop:
        assert not stop.is_set()
        (tmp_path / STOP).touch()
        assert stop.is_set()
    assert not (tmp_path / STOP).exists()
    with _Stop(tmp_path) as stop:
        send(number)
        assert stop.is_set()
        with pytest.raises(KeyboardInterrupt):
            send(number)
