"""Tests share builders; none imports another, so each can be read, moved and run alone."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.architecture.imports import imports

TESTS = Path(__file__).parents[1]
SOURCES = {
    ".".join(("tests", *path.relative_to(TESTS).with_suffix("").parts)): path.read_text("utf-8")
    for path in sorted(TESTS.rglob("*.py"))
}


def breaches(sources: Mapping[str, str]) -> list[str]:
    """Return every import of a test module, and every import of builders from outside builders."""
    found = []
    for module, source in sources.items():
        for target, line, _ in imports(source):
            # the last part may be a module or an object within one
            parts = target.split(".")
            if parts[0] != "tests":
                continue
            if any(part.startswith("test_") or part == "conftest" for part in parts[1:]):
                found.append(f"{module}, line {line}: {target} belongs in tests.builders")
            elif module.startswith("tests.builders") and parts[1] != "builders":
                found.append(f"{module}, line {line}: builders import builders only, not {target}")
    return found


def test_no_test_imports_another() -> None:
    assert len(SOURCES) > 100
    assert breaches(SOURCES) == []


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("tests.test_one", "from tests.scene.test_other import builder"),
        ("tests.test_one", "from tests.scene import test_other as other"),
        ("tests.test_one", "import tests.test_other"),
        ("tests.test_one", "def late():\n    from tests.test_other import builder"),
        ("tests.bench.tool", "from tests.conftest import Somo"),
        ("tests.builders.some", "from tests.truth.surfaces import course"),
    ],
)
def test_an_import_of_a_test_is_found(module: str, source: str) -> None:
    assert len(breaches({module: source})) == 1


def test_an_import_of_a_builder_or_a_tool_is_allowed() -> None:
    source = "from tests.builders.scenes import DEFINITIONS\nfrom tests.truth import surfaces\n"
    assert breaches({"tests.test_one": source}) == []


BUILDERS = {name: source for name, source in SOURCES.items() if name.startswith("tests.builders.")}


def definitions(source: str) -> list[ast.FunctionDef | ast.ClassDef]:
    """Return the public functions and classes of a module."""
    return [
        node
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
    ]


def test_every_builder_says_what_it_returns() -> None:
    silent = [
        f"{module}.{node.name}"
        for module, source in BUILDERS.items()
        for node in definitions(source)
        if not ast.get_docstring(node)
    ]
    assert silent == []


def test_the_name_of_a_builder_is_that_of_nothing_else() -> None:
    homes: dict[str, list[str]] = {}
    for module, source in SOURCES.items():
        for node in definitions(source):
            homes.setdefault(node.name, []).append(module)
    built = {node.name for source in BUILDERS.values() for node in definitions(source)}
    assert {name: homes[name] for name in built if len(homes[name]) > 1} == {}
