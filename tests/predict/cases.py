"""The scenes of the bench: the shipped ones, free motion and contact that nobody tuned for."""

from __future__ import annotations

import dataclasses
import random
from dataclasses import dataclass

from somo_cli.loading import scene_of
from somo_cli.scene.model import Scene
from tests.builders.scenes import DEFINITIONS, scene_from_file
from tests.trust.scenes import random_scenes

SHIPPED_TIME = 0.6  # s
RANDOM = 30
SEED = 5
STEPS = (1e-3, 2e-3)  # s, of the random scenes
ROW = 8e-3  # s


@dataclass(frozen=True, slots=True)
class Case:
    """A scene with its step, and for how long it runs [s]."""

    name: str
    scene: Scene
    duration: float

    @property
    def steps(self) -> int:
        """The number of time steps."""
        return round(self.duration / self.scene.time_step)


def cases() -> list[Case]:
    """Return the shipped scenes and thirty random ones, the same each time."""
    return [*shipped(), *untuned()]


def shipped() -> list[Case]:
    """Return every shipped scene, at the step that it has."""
    names = sorted(path.name for path in DEFINITIONS.glob("*scene.yaml"))
    return [
        _case(name.removesuffix(".yaml"), scene_from_file(name), SHIPPED_TIME) for name in names
    ]


def untuned() -> list[Case]:
    """Return random scenes, of contact and of a finger that is driven by random waves."""
    draw = random.Random(SEED)
    found = []
    contact = iter(random_scenes(6 * RANDOM, SEED))
    while len(found) < RANDOM:
        one = next(contact)
        if "dropped" in one.name:  # a snake takes minutes
            found.append(_free(draw, len(found)))
            continue
        scene, _ = scene_of(one.document())
        scene = dataclasses.replace(scene, time_step=draw.choice(STEPS))
        found.append(_case(one.name, scene, one.duration / 2))
    return found


def _free(draw: random.Random, number: int) -> Case:
    scale = 10 ** draw.uniform(-1, 1)
    sets = (
        f"manipulators[0].definition.actuator_definitions[0].n_segments={draw.choice((5, 10, 20))}",
        "manipulators[0].actuation=[{actuator: 0, axis: 0, wave: "
        f"{{amplitude: {0.05 * scale:.4g}, frequency: {10 ** draw.uniform(-0.5, 1.2):.3g}}}}}]",
    )
    scene = scene_from_file("scene.yaml", *sets)
    scene = dataclasses.replace(scene, time_step=draw.choice(STEPS))
    return _case(f"{number:03d}_free", scene, SHIPPED_TIME)


def _case(name: str, scene: Scene, duration: float) -> Case:
    every = max(2, 2 * round(ROW / scene.time_step / 2))
    return Case(name, dataclasses.replace(scene, every=every, stop_conditions=()), duration)
