"""Soft manipulators described in YAML, compiled to URDF and simulated without a display.

The public Python API; each name is imported when it is first used:

- `load`, `check`, `build`: a file to a document, its problems, its URDF.
- `simulate`: a scene to a `Result`, the columns of `somo run`.
- `Simulation`: a scene stepped by its user, for feedback control and learning.
- `InvalidFile`, `SimulationDiverged`, `EngineMissing`, `EngineRefused`, all a `SomoError`: what
  these raise; `Problem` and `Span`: what is wrong with a file, and where.

The rooms of the code, each of which knows only those before it (`make map` draws the arrows):

- `problems`: what is wrong with a file, and the errors a user can put right.
- `arrays`: array types, and an inverse for small matrices.
- `files`: reads files.
- `output_files`: writes files, whole or not at all.
- `packages`: folders that `package://` paths name.
- `signals`: what a signal raises, and that nothing drops it.
- `budget`: the time and memory that a command may use.
- `terminal_text`: text of files, as a terminal can show it.
- `terminal`: everything that is printed on standard error.
- `document/`: a file as it was written, each value with its line and column.
- `manipulator/`: what a definition means, its chain of links, its URDF.
- `scene/`: what a scene says, in SI; `scene/checks/`: what can be wrong with it, part by part.
- `exchange/`: models for other programs, MJCF and SDF, and their definitions.
- `simulation/plan/`: what is decided before an engine starts, in the engine's units.
- `simulation/dynamics/`: rigid-body dynamics of chains, as arrays.
- `simulation/engine/`: what a run needs of an engine.
- `simulation/engine/bullet/`: PyBullet, which nothing else imports.
- `simulation/integrator/`: the spring-damper law, and what steps one body.
- `simulation/monitoring/`: divergence, penetration, stop conditions, contact events.
- `simulation/recording/`: from states to columns to CSV.
- `simulation/`: the session and the run that bring these together.
- `analysis/`: error against run time, stability and conditioning.
- `calibration/`: from measurements to stiffness, damping and torque.
- `picture/`: pictures and films without a display.
- `document_kinds`: which kind of document a file holds.
- `loading`: from a path to a checked document.
- `api/`: the public Python API.
- `sweep/`: a scene run for many sets of parameters.
- `manual/`: the pages that `somo help` shows.
- `templates/`: first files of a user's own.
- `plot/`: plots of trajectories and of sweeps.
- `cli/`: the commands.

`document/` and `manipulator/` are pure: text in, values out. Each library has one home, and
`tests/architecture/law.py` says which.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0"

if TYPE_CHECKING:
    from somo_cli.api.documents import build as build
    from somo_cli.api.documents import check as check
    from somo_cli.api.documents import load as load
    from somo_cli.api.result import Result as Result
    from somo_cli.api.runs import simulate as simulate
    from somo_cli.api.simulation import Simulation as Simulation
    from somo_cli.document.parse import Document as Document
    from somo_cli.problems import EngineMissing as EngineMissing
    from somo_cli.problems import EngineRefused as EngineRefused
    from somo_cli.problems import InvalidFile as InvalidFile
    from somo_cli.problems import Problem as Problem
    from somo_cli.problems import SimulationDiverged as SimulationDiverged
    from somo_cli.problems import SomoError as SomoError
    from somo_cli.problems import Span as Span

_HOMES = {
    "build": "api.documents",
    "check": "api.documents",
    "load": "api.documents",
    "Result": "api.result",
    "simulate": "api.runs",
    "Simulation": "api.simulation",
    "Document": "document.parse",
    "EngineMissing": "problems",
    "EngineRefused": "problems",
    "InvalidFile": "problems",
    "Problem": "problems",
    "SimulationDiverged": "problems",
    "SomoError": "problems",
    "Span": "problems",
}

__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _HOMES:
        raise AttributeError(f"module 'somo_cli' has no attribute '{name}'")
    value = getattr(import_module(f"somo_cli.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names, those not yet imported among them."""
    return sorted({*globals(), *_HOMES})
