"""What a study asks and what it finds, as plain values."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Literal

from somo_cli.analysis.common_instants import Instants
from somo_cli.analysis.errors import ErrorSummary
from somo_cli.analysis.recorded_errors import RecordedErrors
from somo_cli.analysis.reference import Reference
from somo_cli.scene.model import Integrator, Quantity, Scene

Status = Literal["ok", "diverged", "refused"]


@dataclass(frozen=True, slots=True)
class StudySettings:
    """What to run: steps [s], integrators, numbers of segments (None: as in the scene), instants.

    Each run time is the median of `repeats` runs.
    """

    time_steps: tuple[float, ...]
    integrators: tuple[Integrator, ...]
    segments: tuple[int | None, ...]
    instants: Instants
    repeats: int


@dataclass(frozen=True, slots=True)
class StudyCase:
    """One run: the errors of its time stepping, and its run time [s].

    An error is None where it is smaller than that of the reference. `order` is the order of
    convergence: of the largest tip error, from the next larger step to this one. `recorded` are the
    errors of all that is recorded, where the scene has contact or objects.
    """

    segments: int | None
    integrator: Integrator
    time_step: float
    steps: int
    status: Status
    reason: str = ""
    run_time: float = math.nan
    errors: dict[Quantity, ErrorSummary | None] = dataclasses.field(default_factory=dict)
    order: float = math.nan
    recorded: RecordedErrors | None = None


@dataclass(frozen=True, slots=True)
class Discretization:
    """The scene with one number of segments: its reference, and its distance from a continuum.

    `length` [m] is that of the longest manipulator, `energy` [J] the largest range of one form of
    energy; `model` is the tip error of the chain against the continuum [m], None if unknown.
    """

    segments: int | None
    joints: int
    reference: Reference
    length: float
    energy: float
    model: ErrorSummary | None = None
    recorded: RecordedErrors | None = None
    """What the reference is off by, where the scene has contact or objects."""


@dataclass(frozen=True, slots=True)
class Study:
    """All cases of a study; `model` names the continuum that chains are compared with, if any."""

    settings: StudySettings
    scene: Scene
    discretizations: tuple[Discretization, ...]
    cases: tuple[StudyCase, ...]
    model: str = ""
    model_error: float = math.nan
