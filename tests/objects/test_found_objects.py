"""Objects as they are found in the world: impossible inertias, parts, shared faces, huge sizes."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from somo_cli.manipulator import solids
from somo_cli.picture.drawn_parts import parts_of
from somo_cli.problems import InvalidFile
from somo_cli.scene.model import Scene
from somo_cli.scene.object_shapes import object_link
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan_report import explain
from tests import public_objects
from tests.builders.definitions import actuator, hinge, manipulator
from tests.builders.runs import columns_of
from tests.builders.scenes import scene_from_text
from tests.objects.scenes import INPUTS, problems, scene


def test_a_part_of_one_knot_at_time_zero_takes_no_time() -> None:
    found = columns_of(scene("scene_t.yaml"), 400)
    assert found["time_s"][-1] == 2.0
    assert found["f.actuator_0_axis_0.torque_nm"] == pytest.approx([1, 1.5, 2, 1.5, 1])


@pytest.mark.parametrize("name", ["little", "right"])
def test_a_cube_on_edge_falls_flat(name: str) -> None:
    # the moments of `little` are impossible by what rounding to three digits makes
    assert problems(f"{name}.yaml") == ()
    found = columns_of(scene(f"{name}.yaml"), 2000)
    assert found["cube.angles.x_rad"][-1] == pytest.approx(-0.6, abs=1e-6)
    assert found["cube.pose.z_m"][-1] == pytest.approx(0.5, abs=2e-5)


def test_a_turned_disc_spins_when_it_is_struck() -> None:
    found = columns_of(scene("disc_turned.yaml"), 1000)
    spin = np.array([found[f"plate.spin.{axis}_rad_per_s"] for axis in "xyz"])
    assert np.linalg.norm(spin[:, -1]) > 0.5
    # the ball is not turned by a plane without friction at its centre, so the strike is known
    ball = found["ball.velocity.z_m_per_s"]
    plate = found["plate.velocity.z_m_per_s"]
    assert ball[-1] + 0.01 * plate[-1] == pytest.approx(-0.2, abs=1e-6)


def test_a_placeholder_of_an_inertia_is_a_finding_and_the_solid_takes_its_place() -> None:
    (finding,) = problems("far.yaml")
    assert (finding.severity, finding.code) == ("warning", "declared-inertia")
    assert (finding.span.line, finding.span.column) == (3, 34)
    assert "3e+03 times" in finding.message
    assert problems("far.yaml", "objects[0].inertia=solid") == ()
    (cube,) = scene("far.yaml", "objects[0].inertia=solid").objects
    moment = 0.001 / 6
    assert cube.chain.links[0].inertial.inertia == pytest.approx((moment, 0, 0, moment, 0, moment))


def test_the_solid_may_have_a_mass_of_its_own() -> None:
    sets = ("objects[0].inertia=solid", "objects[0].density=500")
    (cube,) = scene("far.yaml", *sets).objects
    assert cube.chain.links[0].inertial.mass == pytest.approx(500)
    (problem,) = (
        one for one in problems("far.yaml", "objects[0].density=500") if one.severity == "error"
    )
    assert problem.severity == "error"
    assert problem.hint == "leave it out, or set inertia: solid"


def inertia_of(ixx: float, iyy: float, izz: float) -> str:
    return (
        '<robot name="r"><link name="a"><inertial><mass value="1"/>'
        f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}"/></inertial>'
        '<collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>'
    )


def test_an_impossible_inertia_is_reported_with_its_numbers() -> None:
    text = inertia_of(0.1, 0.1, 0.21)
    sets = (f"objects[0].urdf={{source: r.urdf, text: '{text}'}}",)
    (problem,) = problems("right.yaml", *sets)
    assert (problem.severity, problem.code) == ("error", "impossible-inertia")
    assert problem.span.source == "r.urdf"
    assert problem.message == (
        "no body can have the inertia of link 'a': its principal moments 0.1 and 0.1 kg·m² add up "
        "to less than the third, 0.21"
    )
    assert problems("right.yaml", *sets, "objects[0].inertia=solid") == ()


def test_a_rounded_plate_gets_the_nearest_inertia_that_a_body_has() -> None:
    # moments of a plate of 0.347 m by 0.219 m and 1 kg, each rounded to three digits
    x, y = 0.347**2 / 12, 0.219**2 / 12
    a, b, c = (float(f"{moment:.2e}") for moment in (y, x, x + y))
    text = inertia_of(a, b, c + 1e-5)
    urdf = {"source": "r.urdf", "text": text}
    link = object_link({"name": "r", "shape_type": "urdf", "urdf": urdf})
    xx, _, _, yy, _, zz = link.inertial.inertia
    assert zz == pytest.approx(xx + yy, rel=1e-12)
    assert (xx, yy, zz) == pytest.approx((y, x, x + y), rel=0.005)


@pytest.mark.parametrize("name", ["trough_urdf.yaml", "trough_mesh.yaml", "trough_fixed.yaml"])
def test_every_named_part_is_convex_by_itself(name: str) -> None:
    assert problems(name) == ()
    found = columns_of(scene(name), 3000)
    assert found["ball.pose.z_m"][-1] == pytest.approx(0.3, abs=1e-3)


def test_one_hull_around_all_parts_is_used_on_request_and_reported() -> None:
    (warning,) = problems("trough_mesh.yaml", "objects[0].hulls=one")
    assert "collides as its convex hull, which has 257 % more volume" in warning.message
    found = columns_of(scene("trough_mesh.yaml", "objects[0].hulls=one"), 1500)
    assert found["ball.pose.z_m"][-1] == pytest.approx(1.2, abs=1e-3)


def test_boxes_that_share_a_face_are_closed() -> None:
    assert problems("face.yaml") == ()
    (both,) = scene("face.yaml").objects
    inertial = both.chain.links[0].inertial
    assert inertial.centre == pytest.approx((0.5, 0, 0.5))
    wanted = solids.Box((2.0, 1.0, 1.0)).inertia(1.0)
    assert inertial.inertia == pytest.approx(wanted, abs=1e-12)


def test_sizes_and_masses_have_the_bounds_of_other_numbers() -> None:
    (problem,) = problems("huge.yaml")
    assert problem.message.endswith("one of its vertices is at 1e+30 m")
    assert (problem.severity, problem.span.line) == ("error", 4)
    text = (INPUTS / "huge.urdf").read_text("utf-8")
    found = problems(
        "right.yaml", f"objects[0].urdf={{source: huge.urdf, text: {json.dumps(text)}}}"
    )
    assert [(one.span.line, one.message) for one in found] == [
        (3, "value of <mass> is '1e21', too large"),
        (4, "size of <box> is '1e308 0.03 0.03', too large"),
    ]


def test_a_marker_is_recorded_and_touches_nothing() -> None:
    found = columns_of(scene("marker.yaml"), 1000)
    assert found["goal.pose.z_m"][-1] == pytest.approx(0.3)
    assert found["ball.pose.z_m"][-1] == pytest.approx(0.05, abs=1e-3)
    time = found["time_s"][-1]
    assert found["ghost.pose.z_m"][-1] == pytest.approx(-1 - 9.81 * time**2 / 2, rel=1e-2)
    assert not found["ghost.contact.fz_n"].any()


def test_a_marker_needs_to_be_said_to_be_one() -> None:
    (problem,) = problems("marker.yaml", "objects[0].collides=true")
    assert problem.message == "the URDF has no collision shape"
    assert problem.hint.startswith("set collides: false")


@pytest.mark.moderate
def test_pieces_of_a_decomposed_mesh_are_touched_and_always_the_same() -> None:
    sets = ("objects[0].hulls=decompose",)
    (first, _), (second, _) = (scene("trough_mesh.yaml", *sets).objects for _ in range(2))
    assert first.chain == second.chain
    assert len(first.chain.links[0].shapes) > 1
    found = columns_of(scene("trough_mesh.yaml", *sets), 3000)
    assert found["ball.pose.z_m"][-1] == pytest.approx(0.3, abs=0.01)


def test_as_many_parts_as_it_takes() -> None:
    # a row of 40 posts, of which the ball meets the last
    box = (INPUTS / "face.obj").read_text("utf-8").split("o part1")[0].splitlines()[1:]
    lines: list[str] = []
    for number in range(40):
        lines.append(f"o post{number}")
        for line in box:
            kind, *rest = line.split()
            if kind == "v":
                x, y, z = map(float, rest)
                rest = [repr(0.1 * x + 0.2 * number), repr(0.1 * y), repr(0.1 * z)]
            else:
                rest = [str(int(corner) + 8 * number) for corner in rest]
            lines.append(" ".join([kind, *rest]))
    text = "\\n".join(lines)
    sets = (
        f'objects[0].mesh={{source: posts.obj, text: "{text}"}}',
        "objects[1].dimensions=[0.05]",
        "objects[1].position=[7.8, 0, 0.16]",
    )
    found = scene("trough_mesh.yaml", *sets)
    assert len(found.objects[0].chain.links[0].shapes) == 40
    assert columns_of(found, 300)["ball.pose.z_m"][-1] == pytest.approx(0.15, abs=1e-3)
    aside = scene("trough_mesh.yaml", *sets[:2], "objects[1].position=[7.7, 0, 0.16]")
    assert columns_of(aside, 300)["ball.pose.z_m"][-1] < 0.14


def test_volume_of_what_is_left_is_the_same() -> None:
    lines = (INPUTS / "face.obj").read_text("utf-8").splitlines()
    faces = [line for line in lines if line.startswith("f ")]
    text = "\\n".join([*lines, faces[-1], "f 9 9 10"])
    sets = (f'objects[0].mesh={{source: twice.obj, text: "{text}"}}',)
    (warning,) = problems("face.yaml", *sets)
    assert "1 duplicate face and 1 face without area ignored" in warning.message
    (both,) = scene("face.yaml", *sets).objects
    assert both.chain.links[0].inertial.centre == pytest.approx((0.5, 0, 0.5))
    assert math.isclose(both.chain.links[0].inertial.mass, 1.0)


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("block.urdf", []),
        ("soccerball.urdf", []),
        ("sphere2.urdf", []),
        ("tray/traybox.urdf", []),
        ("domino/domino.urdf", []),
        # PyBullet has the inertia of the box around in place of the file's, which no body has
        ("random_urdfs/007/007.urdf", ["inertia (theirs is 3 times that of the box around)"]),
        ("cube_small.urdf", ["inertia (theirs is 3 times that of the box around)"]),
        ("objects/mug.urdf", ["inertia (theirs is 1 times that of the box around)"]),
    ],
)
def test_public_objects_load_as_they_do_in_pybullet(name: str, wanted: list[str]) -> None:
    assert (
        public_objects.differences(public_objects.by_somo(name), public_objects.by_pybullet(name))
        == wanted
    )


def test_the_inertia_of_the_random_objects_is_none() -> None:
    with pytest.raises(InvalidFile) as caught:
        public_objects.scene("random_urdfs/007/007.urdf", "file")
    (problem,) = (one for one in caught.value.problems if one.severity == "error")
    assert "are 1, 1 and 0 kg·m²" in problem.message
    assert problem.hint.endswith("inertia: solid takes those of the shapes")


def test_a_marker_is_drawn() -> None:
    found = scene("marker.yaml")
    parts = parts_of(found)
    assert [part.body for part in parts if part.body > 0] == [1, 2, 3]
    lines = [str(one) for one in explain(make_plan(found))]
    assert "left out  collisions of markers: collides is false of goal, ghost" in lines


def test_the_plan_says_what_was_mended_and_by_how_many_hulls_a_mesh_is_touched() -> None:
    def said(name: str, what: str) -> list[str]:
        return [one.why for one in explain(make_plan(scene(name))) if one.what.startswith(what)]

    (mended,) = said("little.yaml", "inertias")
    assert mended.endswith(
        "of cube link 'cube' has [0.000101, 0.000101, 0.000202] kg·m² in place of "
        "[0.0001, 0.0001, 0.000202] kg·m²"
    )
    assert said("right.yaml", "inertias") == []
    assert said("right.yaml", "meshes") == []
    (hulls,) = said("trough_urdf.yaml", "meshes")
    assert hulls.endswith("trough by 3 hulls")


def raft(shape: str, count: int, folder: Path) -> Scene:
    """Return a scene with a raft of shapes side by side, turned in its file, above the ground."""
    shapes = "".join(
        f'<collision><origin xyz="{0.03 * index} 0 0" rpy="{math.pi / 2} 0 0"/>'
        f"<geometry>{shape}</geometry></collision>"
        for index in range(count)
    )
    inertial = (
        f'<inertial><origin xyz="{0.015 * (count - 1)} 0 0" rpy="0.3 0 0"/><mass value="0.6"/>'
        '<inertia ixx="0.001" iyy="0.012" izz="0.0125" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    text = f'<robot name="raft"><link name="a">{inertial}{shapes}</link></robot>'
    (folder / "raft.urdf").write_text(text, encoding="utf-8")
    data = {
        "time_step": 1e-3,
        "ground": {},
        "objects": [
            {"name": "raft", "shape_type": "urdf", "urdf": "raft.urdf", "position": [0, 0, 0.03]}
        ],
        "manipulators": [
            {"definition": manipulator(actuator(1, hinge(1, 0, 0))), "position": [40, 0, 1]}
        ],
        "record": {"columns": ["tip_position"], "objects": ["pose", "angles"], "every": 10},
    }
    return scene_from_text(json.dumps(data), source=str(folder / "scene.yaml"))


@pytest.mark.parametrize(
    "shape",
    [
        '<capsule radius="0.01" length="0.1"/>',
        '<cylinder radius="0.01" length="0.1"/>',
        '<sphere radius="0.01"/>',
        '<box size="0.02 0.02 0.1"/>',
    ],
)
def test_a_body_of_any_number_of_shapes_falls_and_rests_as_one_of_few(
    shape: str, tmp_path: Path
) -> None:
    # of capsules 15 and 60 shapes of the engine: the first made one by one, the others by a URDF
    for count in (5, 20):
        plan = make_plan(raft(shape, count, tmp_path))
        (planned,) = plan.objects
        assert planned.compound is not None
        assert len(planned.compound.shapes) == count * (3 if "capsule" in shape else 1)
        found = columns_of(plan, 1000)
        assert found["raft.pose.z_m"][-1] == pytest.approx(0.01, abs=3e-5)
        if "sphere" not in shape:  # a row of balls may roll
            assert found["raft.angles.x_rad"][-1] == pytest.approx(0, abs=1e-3)
        assert found["raft.angles.y_rad"][-1] == pytest.approx(0, abs=1e-3)
