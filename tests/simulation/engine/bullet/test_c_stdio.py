"""Whose standard output it is: what the engine prints stays out of results and of the user's."""

from __future__ import annotations

import ctypes
import json
import os
import subprocess
import sys

import pytest

from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import EVERYTHING
from tests.builders.scenes import scene_from_text


def plan() -> Plan:
    return make_plan(scene_from_text(json.dumps({"manipulators": [{"definition": EVERYTHING}]})))


def test_loading_prints_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    os.write(1, b"out before\n")
    os.write(2, b"err before\n")
    with BulletWorld(plan()) as world:
        world.step()
    os.write(1, b"out after\n")
    os.write(2, b"err after\n")
    assert capfd.readouterr() == ("out before\nout after\n", "err before\nerr after\n")


def test_a_world_leaves_standard_output_to_its_user(capfd: pytest.CaptureFixture[str]) -> None:
    with BulletWorld(plan()) as world:
        world.step()
        print("in the world")
        os.write(1, b"by its descriptor\n")
    assert sorted(capfd.readouterr().out.splitlines()) == ["by its descriptor", "in the world"]


def test_a_command_keeps_what_the_engine_prints_out_of_its_results(
    capfd: pytest.CaptureFixture[str],
) -> None:
    os.write(1, b"header\n")
    with stdout_to_stderr(), BulletWorld(plan()):
        os.write(1, b"b3Printf\n")
        ctypes.CDLL(None).puts(b"in the buffer of C")
    os.write(1, b"row\n")
    assert capfd.readouterr() == ("header\nrow\n", "b3Printf\nin the buffer of C\n")


def test_a_closed_standard_error_does_not_stop_a_run() -> None:
    program = (
        "import os; from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr\n"
        "os.close(2)\n"
        "with stdout_to_stderr(): os.write(1, b'inside ')\n"
        "os.write(1, b'after')"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert ended.stdout == b"inside after"
