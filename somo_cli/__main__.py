"""The program `somo`, as a command and as `python -m somo_cli`: one guard around all of it.

Also around the loading of its own modules, which takes a tenth of a second in which a user may
interrupt it or a full disk may refuse what it prints.
"""

from __future__ import annotations

import signal
import sys
from contextlib import suppress
from types import FrameType
from typing import NoReturn

_ENDING = tuple(
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)
)
"""Signals that ask a program to end; files that it has begun are put in order first."""


def main() -> None:
    """Run the command line, and exit with its code."""
    code = 1
    try:
        for number in _ENDING:
            # nohup has it ignored, and so it stays
            if signal.getsignal(number) is signal.SIG_DFL:
                signal.signal(number, _raise_terminated)
        code = _run()
    except KeyboardInterrupt as error:
        code = _code_of(error)
    # what a destructor may print now could only hide the outcome
    with suppress(OSError):
        sys.stderr.flush()
    sys.exit(code)


def _run() -> int:
    from somo_cli import files

    files.open_standard_streams()
    from somo_cli import cli

    try:
        try:
            cli.main()
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else int(ended.code is not None)
        else:
            code = 0
        sys.stdout.flush()
    except BrokenPipeError:
        files.drop_standard_output()
        return 0
    except OSError as error:
        files.drop_standard_output()
        from somo_cli import terminal

        terminal.print_message(f"somo: standard output: {error.strerror or error}")
        return 5
    return code


def _raise_terminated(number: int, frame: FrameType | None) -> NoReturn:
    from somo_cli.problems import Terminated

    for other in _ENDING:  # a second one must not disturb the cleaning up
        signal.signal(other, signal.SIG_IGN)
    raise Terminated(number)


def _code_of(error: KeyboardInterrupt) -> int:
    from somo_cli.problems import Terminated

    return 128 + error.number if isinstance(error, Terminated) else 130


if __name__ == "__main__":
    main()
