"""Objects that come with PyBullet, loaded by somo and by PyBullet's own loader: how many differ.

`python -m tests.public_objects [COUNT]`: all objects of `pybullet_data` that are one rigid body, or
as many of its random ones as COUNT, and every other. Inertia is that of the homogeneous solid,
because the files of the random ones have [1, 1, 0] kg·m², which no body has.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pybullet
import pybullet_data

from somo_cli.arrays import Array
from somo_cli.loading import load_text, scene_of
from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused, InvalidFile
from somo_cli.scene.model import Scene
from somo_cli.scene.proximity import bounding_box
from somo_cli.simulation.engine.bullet.c_stdio import captured_output
from tests.builders.runs import rows_of

DATA = Path(pybullet_data.getDataPath())
STEP, STEPS = 1 / 240, 720
OTHERS = (
    *("cube.urdf", "cube_small.urdf", "block.urdf", "sphere2.urdf", "sphere_small.urdf"),
    *("soccerball.urdf", "duck_vhacd.urdf", "teddy_vhacd.urdf", "jenga/jenga.urdf"),
    *("domino/domino.urdf", "lego/lego.urdf", "tray/tray.urdf", "tray/traybox.urdf"),
    *("objects/mug.urdf", "table/table.urdf", "table_square/table_square.urdf"),
    *("kiva_shelf/model.sdf", "sphere2red_nocol.urdf", "toys/concave_box.urdf"),
    *("toys/prism.urdf", "urdf/mug.urdf", "torus/torus.urdf", "torus/torus_with_plane.urdf"),
)


@dataclass(frozen=True)
class Found:
    """Mass [kg], principal moments [kg·m²], extents [m], and height and tilt where it rests.

    The height is that of the origin of the frame above the ground [m], tilt the direction of
    gravity in the axes of the frame.
    """

    mass: float
    moments: Array
    extents: Array
    height: float
    tilt: Array
    is_static: bool


def names(count: int) -> Iterator[str]:
    """Yield the first so many random objects, and all others that are there."""
    for folder in sorted((DATA / "random_urdfs").iterdir())[:count]:
        if folder.is_dir():
            yield f"random_urdfs/{folder.name}/{folder.name}.urdf"
    yield from (name for name in OTHERS if (DATA / name).is_file() and name.endswith(".urdf"))


SCENE = """
ground: {{friction: 1}}
time_step: {step}
manipulators: [{{definition: {stub}, position: [40, 0, 1]}}]
objects:
  - {{name: thing, shape_type: urdf, urdf: {name}, inertia: {inertia}, place: {{on: ground}}}}
record: {{every: {steps}, columns: [], objects: [pose]}}
"""
STUB = (
    "{manipulator_name: stub, actuator_definitions: [{actuator_length: 0.1, n_segments: 1, "
    "link_definition: {shape_type: box, dimensions: [0.02, 0.02, 0.1], mass: 0.1}, "
    "joint_definitions: [{joint_type: revolute, axis: [1, 0, 0], limits: [-1, 1, 100, 3], "
    "spring_stiffness: 1, spring_damping: 0.01}]}]}"
)


def scene(name: str, inertia: str = "solid") -> Scene:
    """Return the scene of an object on the ground."""
    text = SCENE.format(stub=STUB, name=name, inertia=inertia, step=STEP, steps=STEPS)
    more = ["objects[0].fixed=true"] if is_static(name) else []
    more += ["objects[0].collides=false"] if not has_collision(name) else []
    return scene_of(load_text(text, str(DATA / "scene.yaml"), more))[0]


def is_static(name: str) -> bool:
    """Whether no link of the file has a mass, which PyBullet takes for what stays where it is."""
    masses = re.findall(r"<mass\s+value=\"([^\"]*)\"", (DATA / name).read_text("utf-8"))
    return not any(float(mass) > 0 for mass in masses)


def has_collision(name: str) -> bool:
    """Whether the file has collision shapes."""
    return "<collision" in (DATA / name).read_text("utf-8")


def by_somo(name: str, inertia: str = "solid") -> Found:
    """Load an object with somo. Raises InvalidFile."""
    read = scene(name, inertia)
    (one_object,) = read.objects
    inertial = one_object.chain.links[0].inertial
    box = np.array(bounding_box(one_object.chain, (), Pose()))
    last = rows_of(read, STEPS)[-1][-7:]
    position, turn = np.array(last[:3]), last[3:]
    rotation = np.array(geometry.rotation_from_quaternion(tuple(turn)))
    return Found(
        inertial.mass,
        np.array(geometry.principal_moments(inertial.inertia)),
        box[:, 1] - box[:, 0],
        float(position[2]),
        rotation[2],
        one_object.is_fixed,
    )


def by_pybullet(name: str) -> Found:
    """Load an object with PyBullet's own loader, as its examples do."""
    with captured_output():
        client = pybullet.connect(pybullet.DIRECT)
        try:
            return _by_pybullet(name, client)
        finally:
            pybullet.disconnect(physicsClientId=client)


def _by_pybullet(name: str, client: int) -> Found:
    p: Any = pybullet
    body = p.loadURDF(str(DATA / name), physicsClientId=client)
    mass, _, moments, centre, axes = p.getDynamicsInfo(body, -1, client)[:5]
    low, high = (np.array(one) for one in p.getAABB(body, -1, client))
    ground = p.createCollisionShape(p.GEOM_BOX, halfExtents=[100, 100, 1], physicsClientId=client)
    slab = p.createMultiBody(0, ground, -1, [0, 0, -1], physicsClientId=client)
    for one in (slab, body):
        p.changeDynamics(
            one, -1, lateralFriction=1, linearDamping=0, angularDamping=0, physicsClientId=client
        )
    p.setGravity(0, 0, -9.81, physicsClientId=client)
    position, turn = p.getBasePositionAndOrientation(body, client)
    raised = (position[0], position[1], position[2] - float(low[2]))
    p.resetBasePositionAndOrientation(body, raised, turn, physicsClientId=client)
    for _ in range(STEPS):
        p.stepSimulation(client)
    position, turn = p.getBasePositionAndOrientation(body, client)
    back = p.invertTransform(centre, axes)
    position, turn = p.multiplyTransforms(position, turn, *back)
    rotation = np.array(p.getMatrixFromQuaternion(turn)).reshape(3, 3)
    return Found(mass, np.sort(moments), high - low, position[2], rotation[2], mass == 0)


def differences(ours: Found, theirs: Found) -> list[str]:
    """Return what differs, and by more than is to be expected of the same object."""
    found: list[str] = []
    if ours.is_static != theirs.is_static:
        return ["mobility"]
    size = float(ours.extents.max())
    # theirs has a margin around it, of 1 mm and of 4 % of a hull
    if np.abs(ours.extents - theirs.extents).max() > 0.04 * size + 0.005:
        found.append("bounding box")
    if ours.is_static:
        return found
    if abs(ours.mass - theirs.mass) > 1e-9 * theirs.mass:
        found.append("mass")
    if np.abs(ours.moments - theirs.moments).max() > 0.05 * ours.moments.max():
        found.append(f"inertia ({_reason(theirs)})")
    if abs(ours.height - theirs.height) > 0.02 * size + 0.002:
        found.append("height at rest")
    if np.linalg.norm(ours.tilt - theirs.tilt) > 0.1:
        found.append("side it rests on")
    return found


def _reason(theirs: Found) -> str:
    """Return where PyBullet has an inertia from: the box around, a whole number of times."""
    x, y, z = theirs.extents**2
    box = np.sort(theirs.mass / 12 * np.array([y + z, x + z, x + y]))
    for scaling in (1, 3):  # <inertia_scaling> of the file
        if np.allclose(theirs.moments, scaling * box, rtol=0.02):
            return f"theirs is {scaling} times that of the box around"
    return "theirs is of another kind"


def main() -> None:
    """Print how many objects differ in what, and every one that is refused."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    counts: Counter[str] = Counter()
    refused: dict[str, str] = {}
    total = 0
    for name in names(count):
        total += 1
        try:
            ours = by_somo(name)
        except (InvalidFile, EngineRefused) as error:
            refused[name] = str(error).splitlines()[0]
            if isinstance(error, InvalidFile):
                refused[name] = next(str(one) for one in error.problems if one.severity == "error")
            continue
        found = differences(ours, by_pybullet(name))
        counts.update(found or ["nothing"])
        if not name.startswith("random"):
            print(f"{name}: {', '.join(found) or 'alike'}")
    print(f"{total} objects, {len(refused)} refused; of the others differ in")
    for what, number in counts.most_common():
        print(f"  {what}: {number}")
    for name, why in refused.items():
        print(f"refused {name}: {why}")


if __name__ == "__main__":
    main()
