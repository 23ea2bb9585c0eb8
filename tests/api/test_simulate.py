"""A scene simulated from Python gives what `somo run` writes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import somo_cli as somo
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")

SCENE = DEFINITIONS / "scene.yaml"


@pytest.mark.moderate
@pytest.mark.parametrize("name", ["scene.yaml", "pinch_scene.yaml", "finger.yaml"])
def test_the_csv_is_that_of_the_command(
    tmp_path: Path, environment: dict[str, str], name: str
) -> None:
    output = tmp_path / "run.csv"
    path = str(DEFINITIONS / name)
    command = [sys.executable, "-m", "somo_cli", "run", path, "--steps", "60", "-o", str(output)]
    subprocess.run(command, capture_output=True, env=environment, check=True)
    result = somo.simulate(path, 60)
    assert result.to_csv(tmp_path / "own.csv") == output.read_text()
    assert (tmp_path / "own.csv").read_bytes() == output.read_bytes()
    written = json.loads(output.with_suffix(".meta.json").read_text())
    assert result.metadata["columns"] == written["columns"]
    assert result.metadata["inputs"] == written["inputs"]


def test_columns_are_arrays_by_name() -> None:
    result = somo.simulate(SCENE, 50, every=10, record_only=["finger.tip.*"])
    assert result.names == ("time_s", "finger.tip.x_m", "finger.tip.y_m", "finger.tip.z_m")
    assert result.time.tolist() == [0, 0.01, 0.02, 0.03, 0.04, 0.05]
    assert result["finger.tip.z_m"].shape == (len(result),)
    with pytest.raises(KeyError, match=r"did you mean finger\.tip\.z_m"):
        _ = result["finger.tip.z"]


def test_rows_are_kept_whole_over_many_batches() -> None:
    result = somo.simulate(SCENE, 3000, every=1, record_only=["finger.tip.z_m"])
    again = somo.simulate(SCENE, 3000, every=100, record_only=["finger.tip.z_m"])
    assert np.array_equal(result.values[::100], again.values)


def test_overrides_are_in_the_metadata() -> None:
    document = somo.load(SCENE, sets=["integrator=euler"])
    result = somo.simulate(document, 1)
    assert result.metadata["overrides"] == ["integrator=euler"]
    assert result.metadata["integrator"] == "euler"


def test_wrong_arguments_are_value_errors() -> None:
    with pytest.raises(ValueError, match="no column matches 'nobody'"):
        somo.simulate(SCENE, 1, record_only=["nobody"])
    with pytest.raises(ValueError, match="must not be negative"):
        somo.simulate(SCENE, -1)


def test_divergence_is_raised() -> None:
    document = somo.load(SCENE, sets=["integrator=explicit", "time_step=0.02"])
    with pytest.raises(somo.SimulationDiverged):
        somo.simulate(document, 500)


def test_a_frame_of_pandas_where_it_is_installed() -> None:
    pandas = pytest.importorskip("pandas")
    result = somo.simulate(SCENE, 20)
    frame = result.to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == list(result.names)
