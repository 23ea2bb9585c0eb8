"""Signals that ask the program to end: each is an exception, and none of them is lost.

Python prints and drops an exception in a destructor, a weak reference's callback or an import lock,
and a library in C may drop it without a word. So the handler remembers what it raised.
"""

from __future__ import annotations

import _thread
import signal
import sys
import time
from types import FrameType

from somo_cli.problems import Terminated

_TERMINATING = tuple(
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)
)
_RETRY = 0.02  # s after which a dropped exception is raised again


def handle_endings() -> SignalGuard:
    """Return what now handles each signal that asks the program to end.

    A signal that is ignored stays so, as `nohup` and the background jobs of a shell have it.
    """
    guard = SignalGuard()
    for number in _TERMINATING:
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, guard)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, guard)
    sys.unraisablehook = guard.raise_dropped
    return guard


def guard_in_force() -> SignalGuard | None:
    """Return what handles the signals that ask the program to end, if this module's does."""
    for number in (signal.SIGINT, *_TERMINATING):
        handler = signal.getsignal(number)
        if isinstance(handler, SignalGuard):
            return handler
    return None


class SignalGuard:
    """A handler that raises KeyboardInterrupt, or Terminated, and remembers that it did."""

    def __init__(self) -> None:
        self.number: int | None = None
        """The last signal that was raised as an exception."""
        self._is_dropped = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Raise the exception of a signal; once terminated, files are put in order undisturbed."""
        if self.number in _TERMINATING and not self._is_dropped:
            return
        self._is_dropped = False
        self.number = number
        raise _error_of(number)

    def raise_again(self) -> None:
        """Raise what was raised before and then dropped.

        To be called where work goes on: nothing goes on there once the exception is on its way up.
        """
        if self.number is not None:
            raise _error_of(self.number)

    def raise_dropped(self, dropped: sys.UnraisableHookArgs) -> None:
        """Take the place of `sys.unraisablehook`: raise a dropped exception of a signal again.

        It would be dropped here too, so that the signal is sent a moment later.
        """
        if not isinstance(dropped.exc_value, KeyboardInterrupt) or self.number is None:
            sys.__unraisablehook__(dropped)
            return
        self._is_dropped = True
        _thread.start_new_thread(_send_later, (self.number,))


def _send_later(number: int) -> None:
    time.sleep(_RETRY)
    signal.raise_signal(number)


def _error_of(number: int) -> KeyboardInterrupt:
    return KeyboardInterrupt() if number == signal.SIGINT else Terminated(number)
