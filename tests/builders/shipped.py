"""The shipped definitions and scenes by name, and scenes that come to rest."""

from __future__ import annotations

from functools import cache

from somo_cli import loading
from somo_cli.document.parse import Document
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import compile_definition
from somo_cli.scene.model import Scene, is_scene
from tests.builders.scenes import DEFINITIONS

_NAMES = sorted(
    path.stem for path in DEFINITIONS.glob("*.yaml") if not path.stem.endswith("_study")
)


@cache
def shipped_document(name: str) -> Document:
    """Read a definition or scene of definitions/."""
    return loading.load(str(DEFINITIONS / f"{name}.yaml"))


SHIPPED_CHAINS = [name for name in _NAMES if not is_scene(shipped_document(name))]
SHIPPED_SCENES = [name for name in _NAMES if is_scene(shipped_document(name))]


def shipped_chain(name: str) -> Chain:
    """Compile a definition of definitions/."""
    return compile_definition(shipped_document(name)).chain


@cache
def shipped_scene(name: str) -> Scene:
    """Read a scene of definitions/, without a cache of its files."""
    return loading.scene_of(shipped_document(name))[0]


RESTS = {
    "a hanging finger, loaded and askew": """
manipulators:
  - definition: finger.yaml
    position: [0.1, 0.2, 0.3]
    rpy: [2.5, 0.3, -0.8]
    initial_angles: neutral
    actuation: [{actuator: 0, axis: 0, torque: 0.01}, {actuator: 0, axis: 1, torque: -0.02}]
    loads:
      - {link: tip, force: [0.2, -0.1, 0.05], moment: [0.002, 0.001, -0.003]}
      - {link: actuator_0_segment_04, force: [0, 0, 0.3], frame: body}
""",
    "an assembly": """
manipulators:
  - definition: hand.yaml
    actuation:
      - {limbs: [index, thumb], actuator: 0, axis: 0, torque: 0.02}
""",
    "a planar arm": """
manipulators:
  - definition: planar_arm.yaml
    rpy: [3.141592653589793, 0, 0]
    actuation: [{actuators: all, axis: 0, torque: 0.4}]
""",
}
"""Scenes under gravity, torques and loads that never change."""
