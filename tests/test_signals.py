"""A signal's exception that something drops is raised again."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from somo_cli import signals, terminal
from somo_cli.problems import Terminated

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")

DROPPED = """
import gc, signal, time, weakref
from somo_cli import signals
guard = signals.handle_endings()

class Owner:
    def __del__(self):
        signal.raise_signal(signal.{name})

{drop}
for _ in range(1000):
    time.sleep(0.01)
print("went on to the end")
"""
DROPS = {
    "a destructor": "del [Owner()][0]",
    "a weak reference's callback": (
        "owner = gc.__class__('owner'); "
        "kept = weakref.ref(owner, lambda _: signal.raise_signal(signal.{name})); del owner"
    ),
    "the collection of garbage": "a = [Owner()]; a.append(a); del a; gc.collect()",
}


@pytest.fixture
def guard() -> Iterator[signals.SignalGuard]:
    """A guard in force, until the test is over."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [(number, signal.getsignal(number)) for number in numbers]
    hook = sys.unraisablehook
    yield signals.handle_endings()
    sys.unraisablehook = hook
    for number, handler in before:
        signal.signal(number, handler)


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("drop", DROPS)
def test_an_exception_that_python_drops_is_raised_again(
    environment: dict[str, str], drop: str, name: str
) -> None:
    code = DROPPED.format(drop=DROPS[drop].format(name=name), name=name)
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=60
    )
    assert done.stdout == ""
    assert "Exception ignored" not in done.stderr
    last = "KeyboardInterrupt" if name == "SIGINT" else "somo_cli.problems.Terminated: 15"
    assert done.stderr.splitlines()[-1] == last


def test_where_work_goes_on_a_dropped_exception_is_raised_again(
    guard: signals.SignalGuard,
) -> None:
    with terminal.progress(10, "working") as advance:
        advance(1)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt) as caught:
            advance(2)
        assert not isinstance(caught.value, Terminated)
        with pytest.raises(Terminated) as terminated:
            signal.raise_signal(signal.SIGHUP)
        assert terminated.value.number == signal.SIGHUP
        with pytest.raises(Terminated):
            advance(3)


def test_a_second_signal_does_not_disturb_what_a_first_had_put_in_order(
    guard: signals.SignalGuard,
) -> None:
    with pytest.raises(Terminated):
        signal.raise_signal(signal.SIGTERM)
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        signal.raise_signal(number)
    assert guard.number == signal.SIGTERM


def test_what_is_ignored_stays_ignored(guard: signals.SignalGuard) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    later = signals.handle_endings()
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.raise_signal(number)
    assert (guard.number, later.number) == (None, None)


def test_other_dropped_exceptions_are_printed(
    guard: signals.SignalGuard, capsys: pytest.CaptureFixture[str]
) -> None:
    class Owner:
        def __del__(self) -> None:
            raise ValueError("left behind")

    hook = sys.unraisablehook
    sys.unraisablehook = guard.raise_dropped
    owner = [Owner()]
    owner.clear()
    sys.unraisablehook = hook
    assert "ValueError: left behind" in capsys.readouterr().err
