"""The command sets numpy to one thread before it loads, unless the environment says otherwise."""

from __future__ import annotations

import subprocess
import sys

import pytest

SAY_THREADS = """
import os, sys
import somo_cli
assert "numpy" not in sys.modules and "OPENBLAS_NUM_THREADS" not in os.environ or {given!r}
import somo_cli.cli
assert "numpy" not in sys.modules
print(os.environ["OPENBLAS_NUM_THREADS"])
"""


@pytest.mark.parametrize(("given", "threads"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "2"}, "2")])
def test_numpy_has_one_thread_unless_set_otherwise(
    environment: dict[str, str], given: dict[str, str], threads: str
) -> None:
    unset = {key: value for key, value in environment.items() if key != "OPENBLAS_NUM_THREADS"}
    ended = subprocess.run(
        [sys.executable, "-c", SAY_THREADS.format(given=given)],
        env=unset | given,
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    assert ended.stdout.strip() == threads
