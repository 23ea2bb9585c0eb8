"""What the package depends on, what it ships, and what its code may not do."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.architecture.imports import SOURCES

ROOT = Path(__file__).parents[1]
PROJECT = (ROOT / "pyproject.toml").read_text("utf-8")
# a film is the one thing for which another program runs, and imageio-ffmpeg starts it
FORBIDDEN = {
    *("socket", "ssl", "http", "urllib.request", "ftplib", "smtplib", "requests", "subprocess"),
    *("pickle", "marshal", "shelve", "ctypes", "runpy", "pty", "code", "webbrowser"),
}
ALLOWED = {
    "simulation.engine.bullet.c_stdio": {"ctypes"},  # flushes what the engine printed
    "cli.run_guarded": {"ctypes"},  # has the simulation end with the command
    # writes sums of products: of numbers and of names of its own, of no text of a file
    "simulation.dynamics.straight_code": {"exec"},
}
CALLS = {"eval", "exec", "__import__", "os.system", "os.popen", "yaml.unsafe_load", "yaml.load"}


def dependencies() -> list[str]:
    text = re.sub(r"^ *#.*$", "", PROJECT, flags=re.MULTILINE)
    needed = text.split("\ndependencies = [")[1].split("\n]")[0]
    extras = re.findall(r"^(?:film|plot|cluster) = \[(.*)\]", PROJECT, re.MULTILINE)
    return re.findall(r'"([^"]+)"', "\n".join([needed, *extras]))


def test_every_dependency_has_a_lower_and_an_upper_bound() -> None:
    found = dependencies()
    assert len(found) > 12
    bounded = r"[\w-]+(?:\[\w+\])?>=\d[\d.]*,<\d[\d.]*(?:;.*)?"
    assert [one for one in found if not re.fullmatch(bounded, one)] == []


def test_what_is_shipped_is_text_of_known_kinds() -> None:
    folders = ("definitions", "schemas", "somo_cli")
    assert f'only-include = ["{folders[0]}", "{folders[1]}", "{folders[2]}"]' in PROJECT
    shipped = [path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file()]
    kinds = {".py", ".yaml", ".json", ".obj", ".typed", ".csv", ".md", ".pyc"}
    assert {path.suffix or path.name for path in shipped} <= kinds
    assert not any(path.stat().st_size > 200_000 or path.is_symlink() for path in shipped)


@pytest.mark.parametrize("module", sorted(SOURCES))
def test_no_module_connects_or_runs_anything(module: str) -> None:
    tree = ast.parse(SOURCES[module])
    imported: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imported |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            imported |= {node.module or "", *(f"{node.module}.{one.name}" for one in node.names)}
    called = {ast.unparse(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    allowed = ALLOWED.get(module, set())
    assert (imported & FORBIDDEN - allowed, called & CALLS - allowed) == (set(), set())
