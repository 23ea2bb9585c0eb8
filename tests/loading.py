"""Scenes for tests and measurements, by the same stages as the command line."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from somo_cli import files
from somo_cli.document.edit import override
from somo_cli.document.include import include
from somo_cli.document.parse import Document, parse
from somo_cli.simulation import meaning, run, scene
from somo_cli.simulation.bullet import BulletWorld
from somo_cli.simulation.plan import Plan, make_plan
from somo_cli.simulation.run import Summary
from somo_cli.simulation.scene import Scene

DEFINITIONS = Path(__file__).parents[1] / "definitions"


def scene_from_text(text: str, *sets: str, source: str = str(DEFINITIONS / "test.yaml")) -> Scene:
    """Read a scene, or a definition as the scene of it alone; paths are those of definitions/."""
    document = parse(text, source)
    for assignment in ("", *sets):
        document = override(document, assignment) if assignment else document
        document = _with_parts(document)
    if not scene.is_scene(document):
        document = scene.scene_of_one(document)
    errors = [str(one) for one in meaning.faults(document) if one.severity == "error"]
    assert errors == []
    return scene.read(document)


def scene_from_file(name: str, *sets: str) -> Scene:
    """Read a scene of definitions/."""
    path = DEFINITIONS / name
    return scene_from_text(path.read_text("utf-8"), *sets, source=str(path))


def rows_of(scene_or_plan: Scene | Plan, steps: int) -> list[list[float]]:
    """Simulate and return the recorded rows."""
    return simulated(scene_or_plan, steps)[0]


def simulated(scene_or_plan: Scene | Plan, steps: int) -> tuple[list[list[float]], Summary]:
    """Simulate and return the recorded rows and the summary."""
    plan = scene_or_plan if isinstance(scene_or_plan, Plan) else make_plan(scene_or_plan)
    rows: list[list[float]] = []

    def keep(values: Iterable[float]) -> None:
        rows.append(list(values))

    ticks = iter(range(10))
    with BulletWorld(plan) as world:
        summary = run.run(plan, world, keep, steps, lambda: float(next(ticks)))
    return rows, summary


def _with_parts(document: Document) -> Document:
    places = scene.PLACES_OF_FILES
    if not scene.is_scene(document):
        places = tuple(place[3:] for place in places if len(place) > 3)
    document, problems = include(document, places, files.open_reference)
    assert not problems, problems
    return document
