"""Every code of a finding has its entry in the manual; references have every field and quantity."""

from __future__ import annotations

import ast
import re

import pytest

from somo_cli.document.schemas import load_schema, schema_names
from somo_cli.manual.topics import page
from somo_cli.scene.quantities import BODY_COLUMNS, OBJECT_COLUMNS
from somo_cli.scene.stop_conditions import FINDING_CODES
from tests.architecture.imports import SOURCES

_CODE = re.compile(r"[a-z]+(-[a-z]+)*")


def codes_of_problems() -> set[str]:
    """Return the code of every `Problem(...)` in the source: by keyword, or the fifth argument."""
    found = set()
    for source in SOURCES.values():
        for node in ast.walk(ast.parse(source)):
            if not (isinstance(node, ast.Call) and ast.unparse(node.func) == "Problem"):
                continue
            given = [one.value for one in node.keywords if one.arg == "code"] + node.args[4:5]
            for value in given:
                found |= {
                    one.value
                    for one in ast.walk(value)
                    if isinstance(one, ast.Constant) and isinstance(one.value, str)
                }
    return found


def test_the_walk_finds_codes() -> None:
    found = codes_of_problems()
    assert {"late-springs", "topples", "explicit-step-near-limit", "no-spring"} <= found
    assert all(_CODE.fullmatch(code) for code in found)


@pytest.mark.parametrize("code", sorted({*codes_of_problems(), *FINDING_CODES}))
def test_every_code_has_an_entry(code: str) -> None:
    entries = re.findall(r"^- (`.*?):", page("troubleshooting"), re.MULTILINE)
    assert any(f"`{code}`" in entry for entry in entries)


def test_no_entry_is_left_over() -> None:
    text = page("troubleshooting").partition("## Exit code 4")[0]
    entries = re.findall(r"^- (`.*?):", text, re.MULTILINE)
    named = {code for entry in entries for code in re.findall(r"`([a-z-]+)`", entry)}
    assert named == {*codes_of_problems(), *FINDING_CODES}


def test_the_reference_of_columns_has_every_quantity() -> None:
    rows = page("columns").splitlines()
    for table in (BODY_COLUMNS, OBJECT_COLUMNS):
        for quantity, columns in table.items():
            own = [row for row in rows if row.startswith(f"| `{quantity}` |")]
            assert own, quantity
            assert any(all(f"`{part}`" in row for part in columns.parts) for row in own), quantity


def test_the_reference_of_fields_has_every_field() -> None:
    text = page("fields")
    for name in schema_names():
        for key in load_schema(name)["properties"]:  # type: ignore[attr-defined]
            assert re.search(rf"^- `{key}`", text, re.MULTILINE), (name, key)
    assert "- `time_step`: time step of the simulation [s]" in text
