"""URDFs of one rigid body: what they say, and what is wrong with them."""

from __future__ import annotations

import math

import pytest

from somo_cli.manipulator import solids
from somo_cli.manipulator.round_solids import Capsule
from somo_cli.manipulator.solids import Box, Cylinder, Sphere
from somo_cli.scene import urdf_rigid_body, urdf_xml
from somo_cli.scene.mesh import MeshFile
from tests.builders.definitions import Data
from tests.builders.meshes import BOX_CORNERS, obj
from tests.builders.rigid_objects import object_problems as object_problems

INERTIAL = (
    '<inertial><mass value="2"/>'
    '<inertia ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def robot(*parts: str) -> str:
    return "\n".join(['<robot name="r">', *parts, "</robot>"])


def link(name: str, shape: str = '<sphere radius="1"/>', more: str = INERTIAL) -> str:
    return f'<link name="{name}">{more}<collision><geometry>{shape}</geometry></collision></link>'


def joint(parent: str, child: str, origin: str = "", kind: str = "fixed") -> str:
    return (
        f'<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/>'
        f'<child link="{child}"/>{origin}</joint>'
    )


def urdf_problems(*parts: str) -> list[str]:
    text = robot(*parts)
    names = urdf_xml.mesh_filenames(text, "r.urdf")
    body = urdf_rigid_body.read_rigid_body(
        text, "r.urdf", {name: MeshFile(name, obj(BOX_CORNERS)) for name in names}
    )
    return [f"{one.span.line}: {one.message}" for one in body.problems]


def test_fixed_links_become_one_body() -> None:
    # b stands 1 m beside a, upright as a lies: what is z in b is x in a
    turned = '<origin xyz="1 0 0" rpy="0 1.5707963267948966 0"/>'
    further = '<origin xyz="0 0 2"/>'
    body = urdf_rigid_body.read_rigid_body(
        robot(link("c"), joint("b", "c", further), link("b"), joint("a", "b", turned), link("a")),
        "r.urdf",
        {},
    )
    assert body.problems == []
    # in the order of the links
    assert [one.position for one in body.solids] == [
        pytest.approx((3, 0, 0)),
        pytest.approx((1, 0, 0)),
        pytest.approx((0, 0, 0)),
    ]
    assert body.solids[0].rpy == pytest.approx((0, math.pi / 2, 0))
    whole = solids.lumped(tuple(body.inertials))
    assert whole.mass == 6
    assert whole.centre == pytest.approx((4 / 3, 0, 0))
    # Steiner: 2 · Σ (x - 4/3)², and 1 and 3 change places in b and c
    steiner = 2 * (25 / 9 + 1 / 9 + 16 / 9)
    assert whole.inertia == pytest.approx(
        (3 + 3 + 1, 0, 0, 6 + steiner, 0, 1 + 1 + 3 + steiner), abs=1e-12
    )


def test_every_shape_is_read() -> None:
    shapes = (
        '<box size="1 2 3"/>',
        '<cylinder length="2" radius="1"/>',
        '<capsule length="2" radius="1"/>',
        '<sphere radius="3"/>',
    )
    collisions = "".join(
        f'<collision><origin xyz="0 0 1"/><geometry>{one}</geometry></collision>' for one in shapes
    )
    body = urdf_rigid_body.read_rigid_body(
        robot(f'<link name="a">{collisions}</link>'), "r.urdf", {}
    )
    assert [one.solid for one in body.solids] == [
        Box((1, 2, 3)),
        Cylinder(2, 1),
        Capsule(2, 1),
        Sphere(3),
    ]
    assert {one.position for one in body.solids} == {(0, 0, 1)}
    assert [name for name, _ in body.links_without_inertia] == ["a"]


def test_a_mesh_may_be_mirrored() -> None:
    text = robot(link("a", '<mesh filename="m.obj" scale="-1 1 2"/>'))
    assert list(urdf_xml.mesh_filenames(text, "r.urdf")) == ["m.obj"]
    (found,) = urdf_rigid_body.read_rigid_body(
        text, "r.urdf", {"m.obj": MeshFile("m.obj", obj(BOX_CORNERS))}
    ).solids
    assert found.solid.height == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ([], "1: the URDF has no link"),
        (['<link name="a"/>'], "1: the URDF has no collision shape, so"),
        ([link("a"), link("a")], "3: there is another link 'a'"),
        ([link("a"), link("b")], "1: there are 2 links without a parent: a, b"),
        (["<link/>", link("a")], "2: this link has no name"),
        (
            [link("a"), link("b"), joint("a", "b", kind="revolute")],
            "4: joint 'b_joint' is revolute, not fixed",
        ),
        ([link("a"), link("b"), joint("a", "b", kind="")], "4: joint 'b_joint' has no type"),
        ([link("a"), joint("a", "b")], "3: joint 'b_joint' names 'b', which is not a link"),
        (
            [link("a"), link("b"), link("c"), joint("a", "c"), joint("b", "c")],
            "6: link 'c' has two parents",
        ),
        (
            [link("a"), link("b"), link("c"), joint("b", "c"), joint("c", "b")],
            "4: this link is its own ancestor",
        ),
        ([link("a"), joint("a", "a")], "1: every link has a parent"),
        ([link("a", more="<inertial/>")], "2: <inertial> has no <mass>"),
        ([link("a", '<sphere radius="nan"/>')], "2: radius of <sphere> is 'nan'"),
        ([link("a", "<sphere/>")], "2: <sphere> has no radius"),
        ([link("a", "")], "2: this collision has no geometry"),
        ([link("a", "<mesh/>")], "2: <mesh> has no filename"),
        ([link("a", '<mesh filename="m.ply"/>')], "2: mesh 'm.ply': this is neither"),
        ([link("a", '<mesh filename="m.obj" scale="1 0 1"/>')], "2: scale of <mesh> is '1 0 1'"),
        ([link("a", more=INERTIAL.replace("2", "-1", 1))], "2: the mass is -1 kg, less than 0"),
    ],
)
def test_what_is_wrong(parts: list[str], message: str) -> None:
    (found,) = urdf_problems(*parts)
    assert found.startswith(message)


def test_a_mesh_that_is_not_given() -> None:
    small = '<inertial><mass value="1"/><inertia ixx="3e-4" iyy="3e-4" izz="4e-4"/></inertial>'
    text = robot(link("a", '<mesh filename="m.obj"/>', small))
    (problem,) = urdf_rigid_body.read_rigid_body(text, "r.urdf", {}).problems
    assert problem.message == "mesh 'm.obj' is not given"
    data: Data = {"name": "u", "shape_type": "urdf"}
    data["urdf"] = {"source": "r.urdf", "text": text}
    assert object_problems(data) == ["mesh 'm.obj' is not given"]
    data["urdf"] = {**data["urdf"], "meshes": [{"source": "m.obj", "text": obj(BOX_CORNERS)}]}
    assert object_problems(data) == []


@pytest.mark.parametrize("encoding", ["utf-8", "iso-8859-1", "utf-16"])
def test_the_text_has_been_decoded_whatever_its_head_says(encoding: str) -> None:
    head = f'<?xml version="1.0" encoding="{encoding}"?>'
    body = urdf_rigid_body.read_rigid_body(
        head + robot(link("ü")).replace(INERTIAL, ""), "r.urdf", {}
    )
    assert body.problems == []
    assert [name for name, _ in body.links_without_inertia] == ["ü"]


def test_another_document() -> None:
    body = urdf_rigid_body.read_rigid_body("<sdf/>", "r.urdf", {})
    assert [one.message for one in body.problems] == ["a URDF starts with <robot>, not with <sdf>"]
