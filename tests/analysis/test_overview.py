"""A file at a glance: series of springs, masses and frequencies by closed forms, trees as text."""

from __future__ import annotations

import json
import math

import pytest

from somo_cli.analysis.manipulator_overview import manipulator_overview
from somo_cli.analysis.overview import Entry, tree_lines
from somo_cli.analysis.urdf_overview import MAX_BRANCHES, urdf_overview
from somo_cli.manipulator.urdf import render
from somo_cli.problems import InvalidFile
from tests.builders.command import Somo
from tests.builders.definitions import actuator, chain_of, hinge, manipulator
from tests.builders.pendulum import PENDULUM, PENDULUM_INERTIA
from tests.builders.scenes import DEFINITIONS, scene_from_text


def test_springs_of_an_axis_add_up_in_series() -> None:
    chain = chain_of(manipulator(actuator(4, hinge(1, 0, 0, spring_stiffness=0.6))))
    (of_actuator, _) = manipulator_overview("chain", chain).parts
    (axis,) = of_actuator.parts
    assert axis.facts["stiffness_in_series_nm_per_rad"] == pytest.approx(0.6 / 4)
    assert axis.facts["stiffness_nm_per_rad"] == [0.6] * 4
    assert axis.facts["about"] == "x"


def test_the_frequency_of_a_pendulum_is_that_of_its_spring() -> None:
    (one,) = scene_from_text(PENDULUM).manipulators
    found = manipulator_overview("pendulum", one.compiled.chain)
    assert found.facts["mass_kg"] == pytest.approx(2.0)
    (slowest,) = found.parts[-1].facts["frequencies_hz"]  # type: ignore[misc]
    assert slowest == pytest.approx(math.sqrt(50 / PENDULUM_INERTIA) / math.tau)


def test_parts_are_branches() -> None:
    leaf = Entry("leaf", "green", {})
    tree = Entry("tree", "", {}, [Entry("one", "1", {}, [leaf]), Entry("two", "2", {}, [leaf])])
    lines = ["tree", "├─ one: 1", "│  └─ leaf: green", "└─ two: 2", "   └─ leaf: green"]
    assert list(tree_lines(tree)) == lines


def test_a_scene_says_what_drives_what(somo: Somo) -> None:
    shown = somo("show", str(DEFINITIONS / "lift_scene.yaml"))
    assert (shown.returncode, shown.stderr) == (0, "")
    assert "drive of actuator 0, axis 0: 0 to 0.02929 N·m, 2 waypoints over 0.5 s" in shown.stdout
    assert "cube: box, free, 0.01 kg, on ground, friction 1" in shown.stdout
    plain = json.loads(somo("show", str(DEFINITIONS / "lift_scene.yaml"), "--json").stdout)
    assert [part["name"] for part in plain["parts"]] == ["left", "right", "cube", "ground"]


def test_an_assembly_is_shown_limb_by_limb(somo: Somo) -> None:
    shown = somo("show", str(DEFINITIONS / "hand.yaml")).stdout.splitlines()
    limbs = [line.partition("limb ")[2].partition(":")[0] for line in shown if "limb " in line]
    assert limbs == ["thumb", "index", "middle", "ring", "little"]


def test_what_a_scene_can_record_is_listed(somo: Somo) -> None:
    listed = somo("columns", str(DEFINITIONS / "lift_scene.yaml"), "--json")
    found = json.loads(listed.stdout)
    of_cube = {one["quantity"]: one for one in found if one["owner"] == "cube"}
    assert of_cube["velocity"]["units"] == ["m/s", "rad/s"]
    assert of_cube["velocity"]["recorded"] == 0
    assert of_cube["pose"]["recorded"] == len(of_cube["pose"]["names"]) == 7
    table = somo("columns", str(DEFINITIONS / "lift_scene.yaml")).stdout
    assert ["tip_position", "left", "3", "all", "m", "left.tip.x_m"] in [
        line.split() for line in table.splitlines()
    ]


def test_a_schema_is_printed_as_it_is_shipped(somo: Somo) -> None:
    shipped = (DEFINITIONS.parent / "schemas" / "scene.schema.json").read_text("utf-8")
    assert somo("schema", "scene").stdout == shipped
    assert somo("schema").stdout.count("\n") == len(
        list((DEFINITIONS.parent / "schemas").iterdir())
    )
    wrong = somo("schema", "scen")
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert "there is no schema 'scen'" in wrong.stderr


def test_a_urdf_is_shown_with_its_springs() -> None:
    chain = chain_of(manipulator(actuator(4, hinge(1, 0, 0, spring_stiffness=0.6))))
    shown = urdf_overview(render(chain), "chain.urdf")
    assert shown.facts["mass_kg"] == pytest.approx(sum(one.inertial.mass for one in chain.links))
    assert (shown.facts["moving_joints"], shown.facts["is_in_si"]) == (4, True)
    joints = shown.parts[1:]
    assert [one.facts["stiffness"] for one in joints] == [0.6] * 4
    assert [one.facts["child"] for one in joints] == [one.name for one in chain.links[1:]]
    assert not any(one.parts for one in joints)  # a chain is a list


def test_a_urdf_at_a_world_scale_says_so(somo: Somo) -> None:
    built = somo("build", str(DEFINITIONS / "hand.yaml"), "-o", "hand.urdf")
    assert built.returncode == 0
    shown = somo("show", "hand.urdf").stdout.splitlines()
    assert "not in SI" in shown[0]
    branches = [line for line in shown if line.startswith(("├─ joint", "└─ joint"))]
    limbs = [line.split("joint ")[1].split("_")[0] for line in branches]
    assert limbs == ["thumb", "index", "middle", "ring", "little"]


def _tree(joints: str, links: str = "abc") -> str:
    named = "".join(f'<link name="{one}"/>' for one in links)
    made = "".join(
        f'<joint name="{p}{c}" type="fixed"><parent link="{p}"/><child link="{c}"/></joint>'
        for p, c in joints.split()
    )
    return f'<robot name="r">{named}{made}</robot>'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (_tree("ab"), "there are 2 links without a parent"),
        (_tree("ab bc ab"), "there is another joint"),
        (_tree("ac bc"), "link 'c' has two parents"),
        (_tree("bc cb"), "their own ancestors"),
        (_tree("ab bx"), "which is not a link"),
        ("<sdf/>", "a URDF starts with <robot>"),
        ('<robot name="r"><link name="a"><inertial><mass/></inertial></link></robot>', "no value"),
    ],
)
def test_a_urdf_that_is_no_tree_is_refused(text: str, message: str) -> None:
    with pytest.raises(InvalidFile) as caught:
        urdf_overview(text, "wrong.urdf")
    assert message in caught.value.problems[0].message


def test_branches_on_branches_are_bounded() -> None:
    names = [chr(0x4E00 + index) for index in range(2 * MAX_BRANCHES + 11)]
    joints = []
    for one in range(0, len(names) - 2, 2):  # two children each, the second of which goes on
        joints += [names[one] + names[one + 1], names[one] + names[one + 2]]
    with pytest.raises(InvalidFile, match="branches on branches") as caught:
        urdf_overview(_tree(" ".join(joints), "".join(names)), "deep.urdf")
    assert len(caught.value.problems) == 1
