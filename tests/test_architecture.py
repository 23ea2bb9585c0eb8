"""The import law: who may know whom, and which file is the one home of each library."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

import somo_cli

PACKAGE = Path(somo_cli.__file__).parent

# Every room, and the rooms it may know beside itself.
KNOWS = {
    "problems": {""},
    "terminal": {"", "problems"},
    "arrays": set(),
    "files": {"", "problems"},
    "document": {"", "problems"},
    "manipulator": {"", "problems", "document"},
    "simulation": {"", "arrays", "problems", "document", "manipulator"},
    "analysis": {"", "arrays", "problems", "document", "manipulator", "simulation"},
    "calibration": {"", "arrays", "problems", "document", "manipulator", "simulation", "analysis"},
    "picture": {"", "arrays", "problems", "manipulator", "simulation", "analysis"},
    "loading": {"", "problems", "document", "manipulator", "simulation", "analysis", "files"},
    "cli": {
        "",
        "arrays",
        "problems",
        "document",
        "manipulator",
        "simulation",
        "analysis",
        "calibration",
        "picture",
        "terminal",
        "files",
        "loading",
    },
    "__main__": {"cli"},
    "": set(),  # the package itself: a docstring and a version
}

# Every library that is not the interpreter's own, and the standard ones that are a format.
HOMES = {
    "csv": ("simulation.recorder", "analysis.account", "analysis.trajectory"),
    "imageio_ffmpeg": ("picture.film",),
    "jsonschema": ("document.validate",),
    "matplotlib": ("picture.",),
    "numpy": (
        "arrays",
        "simulation.",
        "analysis.",
        "calibration.",
        "picture.",
        "manipulator.verify",
    ),
    "pybullet": ("simulation.bullet_engine",),
    "referencing": ("document.validate",),
    "rich": ("terminal",),
    "scipy": ("analysis.", "calibration."),
    "trimesh": ("simulation.mesh",),
    "typer": ("cli.",),
    "xml": ("manipulator.urdf", "simulation.urdf_tree"),
    "yaml": ("document.parse",),
    "yourdfpy": ("manipulator.verify",),
}

# Slow to load, so nothing loads them that has not asked for what they do.
HEAVY = {
    "imageio_ffmpeg",
    "matplotlib",
    "numpy",
    "pybullet",
    "rich",
    "scipy",
    "trimesh",
    "yourdfpy",
}


class Import(NamedTuple):
    target: str  # "numpy.linalg", "somo_cli.document.parse"
    line: int
    at_start: bool  # runs when the module is imported, not inside a function


def module_name(path: Path) -> str:
    """`somo_cli/document/parse.py` -> "document.parse"; a room's `__init__.py` -> the room."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(part for part in parts if part != "__init__")


SOURCES = {module_name(path): path.read_text("utf-8") for path in PACKAGE.rglob("*.py")}


def imports(source: str) -> Iterator[Import]:
    """Yield every import, also those inside functions and through `import_module("...")`."""

    def visit(node: ast.AST, at_start: bool) -> Iterator[Import]:
        match node:
            case ast.Import():
                for alias in node.names:
                    yield Import(alias.name, node.lineno, at_start)
            case ast.ImportFrom():
                dots = "." * node.level
                for alias in node.names:
                    # `from somo_cli import terminal` names a room, not a thing within one.
                    inside = f".{alias.name}" if (node.module or "").startswith("somo_cli") else ""
                    yield Import(f"{dots}{node.module or ''}{inside}", node.lineno, at_start)
            case ast.Call(
                func=ast.Attribute(attr="import_module")
                | ast.Name(id="import_module" | "__import__"),
                args=[ast.Constant(value=str(target)), *_],
            ):
                yield Import(target, node.lineno, at_start)
            case ast.If(test=ast.Name(id="TYPE_CHECKING")):
                at_start = False
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            at_start = False
        for child in ast.iter_child_nodes(node):
            yield from visit(child, at_start)

    return visit(ast.parse(source), at_start=True)


def breaches(module: str, source: str) -> list[str]:
    """Return what the module imports against the law, one line each."""
    room = module.partition(".")[0]
    if room not in KNOWS:
        return [f"{room} is a room without a law: say in KNOWS what it may know"]
    found = []
    for target, line, _ in imports(source):
        library, _, rest = target.partition(".")
        if target.startswith("."):
            found.append(f"line {line}: {target} is relative")
        elif library == "somo_cli":
            other = rest.partition(".")[0]
            other = other if other in KNOWS else ""  # `from somo_cli import __version__`
            if other != room and other not in KNOWS[room]:
                found.append(f"line {line}: {room} must not know {other or 'the package'}")
        elif library in HOMES:
            if not any(
                f"{module}.".startswith(home) if home.endswith(".") else module == home
                for home in HOMES[library]
            ):
                found.append(f"line {line}: {library} lives in {' and '.join(HOMES[library])}")
        elif library not in sys.stdlib_module_names:
            found.append(f"line {line}: {library} has no home: give it one in HOMES")
    return found


def loaded_with(module: str) -> set[str]:
    """Return our modules and the libraries that importing the module loads."""
    loaded: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name in loaded:
            continue
        loaded.add(name)
        for target, _, at_start in imports(SOURCES.get(name, "")):
            if not at_start:
                continue
            library, _, rest = target.partition(".")
            if library != "somo_cli":
                loaded.add(library)
                continue
            # The last part may be a module or a thing within one; the rooms on the way load too.
            steps = rest.split(".")
            paths = (".".join(steps[:count]) for count in range(1, len(steps) + 1))
            waiting.extend(path for path in paths if path in SOURCES)
    return loaded


@pytest.mark.parametrize("module", sorted(SOURCES))
def test_every_module_keeps_the_law(module: str) -> None:
    assert breaches(module, SOURCES[module]) == []


def test_a_scene_without_a_mesh_loads_nothing_heavy_before_it_runs() -> None:
    assert loaded_with("loading") & HEAVY == set()


def test_nothing_is_drawn_by_commands_that_draw_nothing() -> None:
    assert not {module for module in loaded_with("cli") if module.startswith("picture")}


@pytest.mark.parametrize("module", ["cli", "document.validate", "manipulator.compile"])
def test_the_door_and_the_compiler_load_nothing_heavy(module: str) -> None:
    assert loaded_with(module) & HEAVY == set()


@pytest.mark.parametrize(
    ("module", "source", "breach"),
    [
        ("document.parse", "import somo_cli.manipulator", "document must not know manipulator"),
        ("document.parse", "from somo_cli import terminal", "document must not know terminal"),
        ("simulation.run", "from somo_cli.files import read_text", "must not know files"),
        ("simulation.run", "import somo_cli.cli", "simulation must not know cli"),
        ("terminal", "from somo_cli.document.parse import Span", "must not know document"),
        ("problems", "from . import document", "is relative"),
        ("manipulator.chain", "def f():\n    import numpy as np", "line 2: numpy lives in"),
        ("simulation.run", "def f():\n    import_module('pybullet')", "pybullet lives in"),
        ("simulation.run", "importlib.import_module('pybullet')", "pybullet lives in"),
        ("cli", "if TYPE_CHECKING:\n    from rich.text import Text", "rich lives in terminal"),
        ("manipulator.urdf", "import trimesh.creation", "trimesh lives in simulation.mesh"),
        ("manipulator.urdf", "import lxml.etree", "lxml has no home"),
        ("cellar.cost", "", "a room without a law"),
    ],
)
def test_the_law_finds_what_breaks_it(module: str, source: str, breach: str) -> None:
    (found,) = breaches(module, source)
    assert breach in found


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("cli", "import typer\nfrom somo_cli import __version__, files, terminal"),
        ("manipulator.urdf", "import math\nimport xml.etree.ElementTree as ElementTree"),
        ("simulation.springs", "import numpy as np\nfrom somo_cli.simulation.plan import Plan"),
        ("manipulator.verify", "def f():\n    import numpy as np\n    import yourdfpy"),
    ],
)
def test_the_law_allows_what_is_lawful(module: str, source: str) -> None:
    assert breaches(module, source) == []
