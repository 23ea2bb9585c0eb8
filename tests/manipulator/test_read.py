from __future__ import annotations

import math

import pytest

from somo_cli.document.parse import parse
from somo_cli.manipulator.definition import (
    Definition,
    JointDefinition,
    LinkDefinition,
    Material,
)
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.read import link_from, read, world_scale
from somo_cli.manipulator.solids import Box, Cylinder, Solid, Sphere
from tests.builders.definitions import (
    BOX,
    CAPSULE,
    CYLINDER,
    EVERYTHING,
    SPHERE,
    STADIUM,
    Data,
    X,
    Y,
    Z,
    actuator,
    document_of,
    hinge,
    manipulator,
)


def definition_of(data: Data) -> Definition:
    return read(document_of(data))


def joint_of(data: Data) -> JointDefinition:
    return definition_of(manipulator(actuator(1, data))).actuators[0].joints[0]


def test_a_link_in_full() -> None:
    data = {
        "shape_type": "box",
        "dimensions": [1, 2, 3],
        "mass": 4,
        "inertial_values": [1, 2, 3, 4, 5, 6],
        "material_color": [0, 0.5, 1, 1],
        "material_name": "sky",
        "origin_offset": [1, 2, 3, 4, 5, 6],
        "visual_geometry_scaling_factor": 2,
    }
    assert link_from(data) == LinkDefinition(
        shape_type="box",
        solid=Box((1.0, 2.0, 3.0)),
        mass=4.0,
        inertia=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
        material=Material("sky", (0.0, 0.5, 1.0, 1.0)),
        offset=(1.0, 2.0, 3.0),
        offset_rpy=(4.0, 5.0, 6.0),
        visual_factor=2.0,
    )


@pytest.mark.parametrize("word", ["left out", None])
def test_a_link_in_short(word: object) -> None:
    optional = ("inertial_values", "material_color", "material_name", "origin_offset")
    nulls = {} if word else dict.fromkeys((*optional, "visual_geometry_scaling_factor"))
    assert link_from({**SPHERE, **nulls}) == LinkDefinition(
        shape_type="sphere",
        solid=Sphere(0.01),
        mass=0.005,
        inertia=None,
        material=Material("grey", (0.6, 0.6, 0.6, 1.0)),
        offset=(0.0, 0.0, 0.0),
        offset_rpy=(0.0, 0.0, 0.0),
        visual_factor=1.0,
    )


@pytest.mark.parametrize(
    ("data", "solid", "height"),
    [
        (BOX, Box((0.023, 0.017, 0.02)), 0.02),
        (STADIUM, Box((0.023, 0.017, 0.02)), 0.02),
        (CYLINDER, Cylinder(0.02, 0.01), 0.02),
        (CAPSULE, Cylinder(0.02, 0.01), 0.02),
        (SPHERE, Sphere(0.01), 0.02),
        ({**CYLINDER, "dimensions": [0.02, 0.01, 7]}, Cylinder(0.02, 0.01), 0.02),
    ],
)
def test_shapes(data: Data, solid: Solid, height: float) -> None:
    link = link_from(data)
    assert (link.solid, link.height) == (solid, height)


def test_a_joint_in_full() -> None:
    data = {
        "joint_type": "revolute",
        "axis": [0, 3, 4],
        "limits": [-1, 2, 3, 4],
        "spring_stiffness": 5,
        "spring_damping": 6,
        "joint_neutral_position": 0.7,
        "neutral_axis_offset": [1, 2, 3, 0, 0, 0],
        "joint_control_limit_force": 8,
        "torque_per_pressure": -9,
    }
    assert joint_of(data) == JointDefinition(
        joint_type="revolute",
        axis=(0.0, 3.0, 4.0),
        lower=-1.0,
        upper=2.0,
        effort=3.0,
        velocity=4.0,
        stiffness=5.0,
        damping=6.0,
        neutral_position=0.7,
        friction=8.0,
        torque_per_pressure=-9.0,
        offset=(1.0, 2.0, 3.0),
    )


def test_a_joint_in_short() -> None:
    joint = joint_of({"joint_type": "continuous", "spring_stiffness": 2})
    assert joint == JointDefinition(
        joint_type="continuous",
        axis=(1.0, 0.0, 0.0),
        lower=0.0,
        upper=-1.0,
        effort=0.0,
        velocity=0.0,
        stiffness=2.0,
        damping=0.0,
        neutral_position=0.0,
        friction=0.0,
        torque_per_pressure=None,
        offset=(0.0, 0.0, 0.0),
    )
    nulls = dict.fromkeys(
        (
            "limits",
            "joint_neutral_position",
            "neutral_axis_offset",
            "joint_control_limit_force",
            "torque_per_pressure",
        )
    )
    assert joint_of({"joint_type": "continuous", "spring_stiffness": 2, **nulls}) == joint


def test_a_continuous_joint_has_no_limits_whatever_the_file_says() -> None:
    joint = joint_of(hinge(1, 0, 0, joint_type="continuous"))
    assert (joint.lower, joint.upper) == (0.0, -1.0)


@pytest.mark.parametrize(
    ("data", "channels", "spans"),
    [
        (actuator(3, X), (0, 0, 0), 1),
        (actuator(3, X, planar_flag=1), (0, 0, 0), 1),
        (actuator(3, X, planar_flag=True), (0, 0, 0), 1),
        (actuator(3, X, Y), (0, 1, 0), 2),
        (actuator(3, X, Y, planar_flag=False), (0, 1, 0), 2),
        (actuator(4, X, Y, Z, planar_flag=0), (0, 1, 2, 0), 3),
        (actuator(2, X, X, planar_flag=2), (0, 0), 1),
        (actuator(1, X, planar_flag=2), (0,), 1),
        (actuator(3.0, X), (0, 0, 0), 1),
    ],
)
def test_who_drives_which_joint(data: Data, channels: tuple[int, ...], spans: int) -> None:
    (found,) = definition_of(manipulator(data)).actuators
    assert found.channels == channels
    assert found.n_segments == len(channels)
    assert found.spans == (spans * 0.02,) * len(channels)


@pytest.mark.parametrize("nothing", ["left out", None, ""])
def test_base_and_tip_may_be_missing(nothing: str | None) -> None:
    keys = ("base_definition", "tip_definition")
    nothings = {} if nothing == "left out" else dict.fromkeys(keys, nothing)
    definition = definition_of(manipulator(actuator(1, X), **nothings))
    assert (definition.base, definition.tips) == (None, ())


def test_one_tip_or_several() -> None:
    one = definition_of(manipulator(actuator(1, X), tip_definition=BOX))
    assert one.tips == (link_from(BOX),)
    several = definition_of(manipulator(actuator(1, X), tip_definitions=[BOX, SPHERE]))
    assert several.tips == (link_from(BOX), link_from(SPHERE))
    for none in (None, []):
        assert definition_of(manipulator(actuator(1, X), tip_definitions=none)).tips == ()
    both = manipulator(actuator(1, X), tip_definition="", tip_definitions=[SPHERE])
    assert definition_of(both).tips == (link_from(SPHERE),)


@pytest.mark.parametrize(
    ("filename", "name"),
    [
        ("a.urdf", "a.urdf"),
        ("urdfs/a.urdf", "a.urdf"),
        ("urdfs\\a.urdf", "a.urdf"),
        (None, None),
    ],
)
def test_the_name_of_the_urdf_has_no_folder(filename: str | None, name: str | None) -> None:
    definition = definition_of(manipulator(actuator(1, X), urdf_filename=filename))
    assert definition.urdf_filename == name


@pytest.mark.parametrize(
    ("text", "scale"),
    [
        ("{}", None),
        ("world_scale: 20", Scale(20.0)),
        ("world_scale: {length: 20}", Scale(20.0)),
        ("world_scale: {mass: 3}", Scale(1.0, 3.0)),
        ("world_scale: {length: 0.5, mass: 3}", Scale(0.5, 3.0)),
        ("world_scale: {}", Scale()),
    ],
)
def test_the_world_scale(text: str, scale: Scale | None) -> None:
    assert world_scale(parse(text, "f.yaml")) == scale


def test_every_number_is_a_float() -> None:
    def floats_only(value: object) -> bool:
        if isinstance(value, tuple):
            return all(map(floats_only, value))
        return not isinstance(value, int)

    definition = definition_of(EVERYTHING)
    for one in definition.actuators:
        for joint in one.joints:
            assert floats_only((joint.axis, joint.lower, joint.upper, joint.effort, joint.offset))
            assert not math.isnan(joint.stiffness)
        assert floats_only((one.link.mass, one.link.offset, one.link.material.rgba))
        assert floats_only(one.spans)


def test_a_definition_inside_a_scene() -> None:
    scene = {"manipulators": [{"definition": EVERYTHING}]}
    inside = read(document_of(scene), ("manipulators", 0, "definition"))
    assert inside == definition_of(EVERYTHING)
