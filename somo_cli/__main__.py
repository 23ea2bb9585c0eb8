"""The program `somo`, as a command and as `python -m somo_cli`: one guard around all of it.

Also around the loading of its own modules, which takes a tenth of a second in which a user may
interrupt it or a full disk may refuse what it prints.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from somo_cli.signals import SignalGuard


def main() -> None:
    """Run the command line, and exit with its code."""
    guard = None
    try:
        from somo_cli import signals

        guard = signals.handle_endings()
        code = _code_of(_run(), guard)
    except KeyboardInterrupt:
        code = _code_of(128 + signal.SIGINT, guard)
    # what a destructor may print now could only hide the outcome
    with suppress(OSError):
        sys.stderr.flush()
    if code <= 128:
        sys.exit(code)
    # Python itself may have noted the interrupt, and would end by that signal and not with a code
    with suppress(OSError):
        sys.stdout.flush()
    os._exit(code)


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


def _code_of(code: int, guard: SignalGuard | None) -> int:
    """Return the exit code; that of a signal too where its exception did not come this far."""
    is_of_a_signal = code == 0 or code > 128
    return 128 + guard.number if guard is not None and guard.number and is_of_a_signal else code


if __name__ == "__main__":
    main()
