"""Which room may import which, and which module is the one home of each library."""

from __future__ import annotations

import sys

from tests.architecture.imports import imports

_GROUND = {"", "problems", "arrays"}
_MEANING = {*_GROUND, "document", "manipulator"}
_SCENE = {*_MEANING, "scene"}
_PLAN = {*_GROUND, "manipulator", "scene", "simulation.plan"}
_ENGINE = {*_PLAN, "simulation.dynamics", "simulation.engine"}
_MOTION = {*_ENGINE, "simulation.integrator"}
_RUN = {*_MOTION, "simulation.monitoring", "simulation.recording", "simulation"}

KNOWS: dict[str, set[str]] = {
    "problems": set(),
    "arrays": set(),
    "files": {"", "problems"},
    "output_files": set(),
    "packages": {"", "problems", "files"},
    "signals": {"", "problems"},
    "budget": {"", "problems"},
    "terminal_text": set(),
    "terminal": {"", "problems", "signals", "budget", "terminal_text"},
    "document": {"", "problems"},
    "manipulator": {"", "problems", "document"},
    "scene": _MEANING - {"arrays"},
    "scene.checks": _SCENE - {"arrays"},
    "exchange": _SCENE - {"arrays", "document"},
    "simulation.plan": _PLAN - {"simulation.plan"},
    "simulation.dynamics": _PLAN,
    "simulation.engine": _PLAN | {"simulation.dynamics"},
    "simulation.engine.bullet": _ENGINE,
    "simulation.integrator": _ENGINE,
    "simulation.monitoring": _MOTION,
    "simulation.recording": _MOTION | {"simulation.monitoring"},
    "simulation": _RUN,
    "analysis": _RUN | {"document"},
    "calibration": _RUN | {"document", "analysis"},
    "picture": _RUN | {"simulation.engine.bullet", "analysis"},
    "document_kinds": _MEANING - {"arrays"} | {"scene", "scene.checks"},
    "loading": _RUN
    | {
        "document_kinds",
        "document",
        "scene.checks",
        "simulation.engine.bullet",
        "analysis",
        "files",
        "packages",
    },
    "api": _RUN
    | {
        "exchange",
        "document",
        "scene.checks",
        "simulation.engine.bullet",
        "analysis",
        "files",
        "output_files",
        "document_kinds",
        "loading",
    },
    "sweep": _SCENE
    | {
        "scene.checks",
        "simulation",
        "simulation.plan",
        "files",
        "output_files",
        "packages",
        "document_kinds",
        "loading",
        "api",
    },
    "manual": {"", "files", "document", "scene"},
    "templates": {""},
    "plot": {"", "problems", "arrays", "document", "scene"},
    "cli": _RUN
    | {
        "api",
        "sweep",
        "plot",
        "manual",
        "templates",
        "document",
        "scene.checks",
        "simulation.engine.bullet",
        "analysis",
        "calibration",
        "picture",
        "exchange",
        "budget",
        "terminal",
        "files",
        "output_files",
        "packages",
        "document_kinds",
        "loading",
    },
    "__main__": {"", "files", "signals", "terminal", "cli"},
    "": {"api", "document", "problems"},  # the public API, imported when it is used
}
"""Every room from the ground up, and the rooms that it may import beside itself."""

HOMES: dict[str, tuple[str, ...]] = {
    "csv": ("analysis.study_export", "sweep.results"),
    "distributed": ("sweep.cluster",),
    "imageio_ffmpeg": ("picture.film",),
    "jsonschema": ("document.schemas", "document.schema_errors", "document.validate"),
    "matplotlib": ("picture.", "plot."),
    "numpy": (
        "api.",
        "arrays",
        "scene.mesh",
        "scene.mesh_parts",
        "scene.closed_surface",
        "scene.compound",
        "simulation.",
        "analysis.",
        "calibration.",
        "picture.",
        "plot.",
        "sweep.",
        "manipulator.urdf_readback",
    ),
    "pandas": ("api.result",),
    "pybullet": ("simulation.engine.bullet.client",),
    "referencing": ("document.schemas",),
    "rich": ("terminal",),
    "scipy": ("analysis.", "calibration.", "sweep.points"),
    "trimesh": ("scene.mesh", "scene.mesh_parts", "scene.closed_surface"),
    "typer": ("cli.",),
    "xml": ("manipulator.urdf", "scene.urdf_xml", "exchange."),
    "yaml": (
        "document.parse",
        "document.yaml_nodes",
        "document.yaml_syntax",
        "document.yaml_values",
    ),
    "yourdfpy": ("manipulator.urdf_readback",),
}
"""Every library that is not the interpreter's own, and the standard ones that are a format."""

HEAVY = {
    "distributed",
    "imageio_ffmpeg",
    "matplotlib",
    "numpy",
    "pandas",
    "pybullet",
    "rich",
    "scipy",
    "trimesh",
    "yourdfpy",
}
"""Slow to load, so nothing loads them that has not asked for what they do."""


def room_of(module: str) -> str | None:
    """Return the innermost room that a module lies in; None if no room of the law holds it."""
    name = module
    while name not in KNOWS:
        if "." not in name:
            return "" if name == "" else None
        name = name.rpartition(".")[0]
    return name


def breaches(module: str, source: str) -> list[str]:
    """Return what the module imports against the law, one line each."""
    room = room_of(module)
    if room is None:
        return [f"{module} is in no room of the law: say in KNOWS what it may know"]
    found = []
    for target, line, _ in imports(source):
        library, _, rest = target.partition(".")
        if target.startswith("."):
            found.append(f"line {line}: {target} is relative")
        elif library == "somo_cli":
            other = room_of(rest) or ""  # `from somo_cli import __version__`
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
