"""SDF of every shipped definition: elements of the format, exact numbers, and Drake's opinion."""

from __future__ import annotations

import importlib.util
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from somo_cli.exchange import sdf
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from tests.builders.definitions import EVERYTHING, compiled
from tests.builders.scenes import scene_from_text
from tests.builders.shipped import RESTS, SHIPPED_CHAINS, shipped_chain

needs_drake = pytest.mark.skipif(
    importlib.util.find_spec("pydrake") is None, reason="drake is not installed"
)
POSE_OR_SHAPE = {"pose", "geometry", "material"}
CHILDREN = {
    "sdf": {"model"},
    "model": {"link", "joint", "frame"},
    "frame": {"pose"},
    "link": {"pose", "inertial", "visual", "collision"},
    "inertial": {"pose", "mass", "inertia"},
    "inertia": {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"},
    "visual": POSE_OR_SHAPE,
    "collision": {"pose", "geometry"},
    "geometry": {"box", "cylinder", "sphere"},
    "box": {"size"},
    "cylinder": {"radius", "length"},
    "sphere": {"radius"},
    "material": {"ambient", "diffuse"},
    "joint": {"pose", "parent", "child", "axis"},
    "axis": {"xyz", "limit", "dynamics"},
    "limit": {"lower", "upper", "effort", "velocity"},
    "dynamics": {"damping", "friction", "spring_reference", "spring_stiffness"},
}
"""What each element may hold, in the specification of SDF 1.9; others hold text."""
NUMBERS = {"pose": 6, "size": 3, "xyz": 3, "ambient": 4, "diffuse": 4}
TEXTS = {"parent", "child"}


def check(element: ET.Element) -> None:
    """Fail for an element in a wrong place, a wrong count of numbers, or a name used twice."""
    allowed = CHILDREN.get(element.tag)
    if allowed is None:
        assert len(element) == 0
        assert element.text
        if element.tag not in TEXTS:
            values = [float(word) for word in element.text.split()]
            assert len(values) == NUMBERS.get(element.tag, 1)
            assert np.isfinite(values).all()
        return
    assert {child.tag for child in element} <= allowed
    names = [child.get("name") for child in element if child.get("name")]
    assert len(names) == len(set(names))
    for child in element:
        check(child)


def text_of(root: ET.Element, path: str) -> list[float]:
    found = root.findtext(path)
    assert found is not None
    return [float(word) for word in found.split()]


@pytest.mark.parametrize("name", SHIPPED_CHAINS)
def test_elements_are_those_of_the_format_and_numbers_are_exact(name: str) -> None:
    chain = shipped_chain(name)
    text = sdf.render_chain(chain, "tool")
    assert text == sdf.render_chain(shipped_chain(name), "tool")
    root = ET.fromstring(text)
    check(root)
    model = root[0]
    for link, element in zip(chain.links, model.findall("link"), strict=True):
        assert element.get("name") == link.name
        assert text_of(element, "inertial/mass") == [link.inertial.mass]
        inertia = [float(one.text or "nan") for one in element.findall("inertial/inertia/*")]
        assert tuple(inertia) == link.inertial.inertia
    joints = [one for one in model.findall("joint") if one.get("type") != "fixed"]
    for joint, element in zip(chain.joints, joints, strict=True):
        dynamics = "axis/dynamics/"
        assert text_of(element, dynamics + "spring_stiffness") == [joint.stiffness]
        assert text_of(element, dynamics + "spring_reference") == [joint.neutral_position]
        assert text_of(element, dynamics + "damping") == [joint.damping]
        assert text_of(element, dynamics + "friction") == [joint.friction]
        assert text_of(element, "axis/xyz") == list(joint.axis)
        assert text_of(element, "pose") == [*joint.origin, *joint.rpy]


def test_a_free_base_has_no_joint_to_the_world() -> None:
    chain = compiled(EVERYTHING).chain
    for is_fixed in (True, False):
        text = sdf.render_chain(chain, is_fixed=is_fixed)
        check(ET.fromstring(text))
        assert ("world" in text) == is_fixed


# Drake reads SDF and acts on its springs


def plant_of(chain: Chain, gravity: list[float]):
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(sdf.render_chain(chain), "sdf")
    plant.mutable_gravity_field().set_gravity_vector(gravity)
    plant.Finalize()
    return plant


@needs_drake
@pytest.mark.parametrize("name", SHIPPED_CHAINS)
def test_drake_reads_the_same_model(name: str) -> None:
    chain = shipped_chain(name)
    plant = plant_of(chain, [0, 0, -9.81])
    state = plant.CreateDefaultContext()
    angles = np.random.default_rng(3).uniform(-1, 1, len(chain.joints))
    for joint, angle in zip(chain.joints, angles, strict=True):
        plant.GetJointByName(joint.name).set_angle(state, angle)
    poses = link_poses(chain, angles.tolist(), Pose())
    for link, pose in zip(chain.links, poses, strict=True):
        body = plant.GetBodyByName(link.name)
        assert body.get_mass(state) == pytest.approx(link.inertial.mass, rel=1e-15)
        place = body.EvalPoseInWorld(state)
        np.testing.assert_allclose(
            place.translation(), pose.position, atol=1e-9 * max(chain.length, 1e-3)
        )
        np.testing.assert_allclose(place.rotation().matrix(), pose.rotation, atol=1e-9)


@needs_drake
@pytest.mark.parametrize("name", RESTS)
def test_springs_act_in_drake(name: str) -> None:
    """The torques of springs and gravity at a bent pose are ours, so the rest is the same."""
    from pydrake.multibody.tree import MultibodyForces

    scene = scene_from_text(RESTS[name])
    (one,) = scene.manipulators
    chain = one.compiled.chain
    turned = np.array(one.pose.rotation).T @ np.array(scene.gravity)
    plant = plant_of(chain, turned.tolist())
    state = plant.CreateDefaultContext()
    random = np.random.default_rng(5)
    angles = random.uniform(-0.5, 0.5, len(chain.joints))
    joints = [plant.GetJointByName(joint.name) for joint in chain.joints]
    for joint, angle in zip(joints, angles, strict=True):
        joint.set_angle(state, angle)
    forces = MultibodyForces(plant)
    plant.CalcForceElementsContribution(state, forces)
    found = -plant.CalcInverseDynamics(state, np.zeros(plant.num_velocities()), forces)
    order = [joint.velocity_start() for joint in joints]
    dynamics = ChainDynamics(chain)
    pose = dynamics.at(angles, Pose())
    spring = -np.array([j.stiffness for j in chain.joints]) * (
        angles - np.array(chain.neutral_angles)
    )
    expected = spring + pose.gravity_force((turned[0], turned[1], turned[2]))[6:]
    np.testing.assert_allclose(found[order], expected, atol=1e-9 * np.abs(expected).max())
