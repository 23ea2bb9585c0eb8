"""The Python of the README runs as it stands there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")


@pytest.mark.moderate
def test_the_example_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(DEFINITIONS.parent)
    readme = Path("README.md").read_text("utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", readme, re.DOTALL)
    names: dict[str, Any] = {}
    exec(example, names)
    assert names["problems"] == ()
    assert names["urdf"].startswith("<?xml")
    assert len(names["tip"]) == 201
    assert names["simulation"].time_step == 1e-3
