"""The law of imports holds: which room knows which, and one home for each library."""

from __future__ import annotations

import ast

import pytest

from tests.architecture.imports import PACKAGE, SOURCES, loaded_with
from tests.architecture.law import HEAVY, KNOWS, breaches
from tests.architecture.map import against, circles, drawn, rooms


@pytest.mark.parametrize("module", sorted(SOURCES))
def test_every_module_keeps_the_law(module: str) -> None:
    assert breaches(module, SOURCES[module]) == []


def test_no_room_imports_one_above_it_and_none_a_circle() -> None:
    assert (against(rooms()), circles(rooms())) == ([], [])


def test_the_map_counts_circles() -> None:
    found = dict(rooms())
    found["problems"] = found["problems"]._replace(knows={"document": 1})
    assert circles(found) == [("problems", "document", "problems")]
    assert drawn(found).endswith("1 against the stream, 1 circles")


def test_the_contributors_page_has_the_map_as_it_is() -> None:
    page = (PACKAGE.parent / ".github" / "CONTRIBUTING.md").read_text("utf-8")
    drawing = "".join(f"    {line}\n" for line in drawn(rooms()).splitlines())
    assert drawing in page, "make map prints it anew"


def test_the_package_lists_every_room() -> None:
    reported = ast.get_docstring(ast.parse(SOURCES[""])) or ""
    missing = [
        room
        for room in KNOWS
        if room not in ("", "__main__") and f"`{room.replace('.', '/')}" not in reported
    ]
    assert missing == []


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
        (
            "simulation.integrator.joint_limits",
            "from somo_cli.simulation.engine.bullet.world import BulletWorld",
            "simulation.integrator must not know simulation.engine.bullet",
        ),
        (
            "scene.model",
            "from somo_cli.scene.checks import scene",
            "scene must not know scene.checks",
        ),
        ("terminal", "from somo_cli.document.parse import Span", "must not know document"),
        ("problems", "from . import document", "is relative"),
        ("manipulator.chain", "def f():\n    import numpy as np", "line 2: numpy lives in"),
        ("simulation.run", "def f():\n    import_module('pybullet')", "pybullet lives in"),
        ("simulation.run", "importlib.import_module('pybullet')", "pybullet lives in"),
        ("cli", "if TYPE_CHECKING:\n    from rich.text import Text", "rich lives in terminal"),
        ("manipulator.urdf", "import trimesh.creation", "trimesh lives in scene.mesh"),
        ("manipulator.urdf", "import lxml.etree", "lxml has no home"),
        ("cellar.cost", "", "in no room of the law"),
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
        (
            "simulation.integrator.implicit_law",
            "import numpy as np\nfrom somo_cli.simulation.plan.model import Plan",
        ),
        ("manipulator.urdf_readback", "def f():\n    import numpy as np\n    import yourdfpy"),
    ],
)
def test_the_law_allows_what_is_lawful(module: str, source: str) -> None:
    assert breaches(module, source) == []
