"""Benches and studies are run by hand, rarely; that each imports what is there is tested here."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
TOOLS = [
    ".".join(("tests", *path.relative_to(TESTS).with_suffix("").parts))
    for path in sorted(TESTS.rglob("*.py"))
    if not path.name.startswith(("test_", "conftest", "__init__"))
]


@pytest.mark.parametrize("module", TOOLS)
def test_a_tool_imports(module: str) -> None:
    importlib.import_module(module)
