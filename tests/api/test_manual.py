"""The Python of the manual and of the README runs as it stands there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from somo_cli.manual.topics import page
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")


@pytest.mark.moderate
def test_the_example_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(DEFINITIONS.parent)
    names = _run(page("python"))
    assert names["problems"] == ()
    assert names["urdf"].startswith("<?xml")
    assert len(names["tip"]) == 201
    assert names["simulation"].time_step == 1e-3


def test_the_example_of_the_readme_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(DEFINITIONS.parent)
    assert len(_run(Path("README.md").read_text("utf-8"))["tip"]) == 201


def _run(markdown: str) -> dict[str, Any]:
    """Run the one Python block of a page; return the names that it defines."""
    (example,) = re.findall(r"```python\n(.*?)```", markdown, re.DOTALL)
    names: dict[str, Any] = {}
    exec(example, names)
    return names
