"""Loading, checking and building from Python."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import somo_cli as somo
from tests.builders.scenes import DEFINITIONS

BROKEN = "manipulators:\n  - definition: missing.yaml\ntime_step: -1\n"


def test_every_error_of_a_file_is_raised_at_once_with_its_position(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(BROKEN)
    with pytest.raises(somo.InvalidFile) as caught:
        somo.load(scene)
    places = {(one.span.line, one.severity) for one in caught.value.problems}
    assert places == {(2, "error"), (3, "error")}


def test_check_returns_the_same_errors_and_raises_none(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(BROKEN)
    assert {one.span.line for one in somo.check(scene)} == {2, 3}
    assert somo.check(DEFINITIONS / "scene.yaml") == ()


def test_sets_override_values_and_a_wrong_one_is_an_error() -> None:
    document = somo.load(DEFINITIONS / "scene.yaml", sets=["integrator=euler"])
    assert document.at(("integrator",)) == "euler"
    with pytest.raises(somo.InvalidFile, match="integrator"):
        somo.load(DEFINITIONS / "scene.yaml", sets=["integrator=magic"])


def test_build_returns_the_urdf_that_the_command_writes(environment: dict[str, str]) -> None:
    path = str(DEFINITIONS / "finger.yaml")
    command = [sys.executable, "-m", "somo_cli", "build", path, "-o", "-", "--scale", "3"]
    written = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert somo.build(path, scale=3.0) == written.stdout
    assert somo.build(somo.load(path), tip_frame="end").count('"end"') == 2


def test_importing_the_package_imports_nothing_else(environment: dict[str, str]) -> None:
    script = (
        "import sys, somo_cli\n"
        "print({name for name in sys.modules if name.startswith('somo_cli.')})\n"
        "print(all(hasattr(somo_cli, name) for name in somo_cli.__all__))"
    )
    command = [sys.executable, "-c", script]
    reported = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert reported.stdout.splitlines() == ["set()", "True"]


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        _ = somo.simulat
    assert {"simulate", "Simulation", "Result"} <= set(dir(somo))


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("name", "kind"), [("finger", "sdf"), ("finger", "mjcf"), ("scene", "mjcf")]
)
def test_other_formats_are_those_of_the_command(
    name: str, kind: str, environment: dict[str, str]
) -> None:
    path = str(DEFINITIONS / f"{name}.yaml")
    command = [sys.executable, "-m", "somo_cli", "build", path, "-o", "-", "--format", kind]
    written = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert somo.build(path, format=kind) == written.stdout


def test_si_formats_take_no_scale() -> None:
    with pytest.raises(ValueError, match="no scale"):
        somo.build(DEFINITIONS / "finger.yaml", scale=20, format="sdf")
