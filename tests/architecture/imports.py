"""What every module of the package imports, read from the source without running it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import somo_cli

PACKAGE = Path(somo_cli.__file__).parent


class Import(NamedTuple):
    """One import: what it names, where, and whether it runs when the module is imported."""

    target: str  # "numpy.linalg", "somo_cli.document.parse"
    line: int
    at_start: bool


def module_name(path: Path) -> str:
    """`somo_cli/document/parse.py` -> "document.parse"; a room's `__init__.py` -> the room."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(part for part in parts if part != "__init__")


OURS = ("somo_cli", "tests")
SOURCES = {module_name(path): path.read_text("utf-8") for path in sorted(PACKAGE.rglob("*.py"))}


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
                    # `from somo_cli import terminal` names a room, not an object within one
                    inside = f".{alias.name}" if (node.module or "").startswith(OURS) else ""
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


def module_of(target: str) -> str:
    """Return the module of ours that a dotted target lies in; the target may name an object."""
    name = target.removeprefix("somo_cli").removeprefix(".")
    while name and name not in SOURCES:
        name = name.rpartition(".")[0]
    return name


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
            # the last part may be a module or an object within one; the rooms on the way load too
            steps = rest.split(".")
            paths = (".".join(steps[:count]) for count in range(1, len(steps) + 1))
            waiting.extend(path for path in paths if path in SOURCES)
    return loaded
