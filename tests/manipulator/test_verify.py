from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from typing import Any

import pytest

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.manipulator.urdf import render
from somo_cli.manipulator.urdf_readback import require_equal
from somo_cli.problems import EngineRefused
from tests.builders.definitions import (
    BOX,
    EVERYTHING,
    SPHERE,
    X,
    Y,
    actuator,
    chain_of,
    manipulator,
)


@pytest.fixture(scope="module")
def chain() -> Chain:
    return chain_of(manipulator(actuator(2, X, Y), base_definition=BOX, tip_definition=SPHERE))


def refusal(text: str, chain: Chain) -> str:
    with pytest.raises(EngineRefused) as caught:
        require_equal(text, chain)
    assert caught.value.body == chain.name
    prefix = "read back, the URDF differs: "
    assert caught.value.reason.startswith(prefix)
    return caught.value.reason.removeprefix(prefix)


@pytest.mark.parametrize("scale", [Scale(), Scale(20), Scale(1e-3, 1e-3), Scale(1000, 1e6)])
@pytest.mark.parametrize("tip_frame", [None, "tip"])
def test_what_we_write_is_what_we_meant(scale: Scale, tip_frame: str | None) -> None:
    chain = scaled(chain_of(EVERYTHING), scale)
    require_equal(render(chain, tip_frame), chain)


def test_many_joints() -> None:
    chain = chain_of(manipulator(actuator(60, X, Y)))
    require_equal(render(chain), chain)


def test_no_joints() -> None:
    chain = chain_of(manipulator(actuator(2, {"joint_type": "fixed"})))
    require_equal(render(chain, "tip"), chain)


JOINT, LINK = "actuator_0_joint_01", "actuator_0_segment_01"


@pytest.mark.parametrize(
    ("pattern", "replacement", "reason"),
    [
        ('robot name="body"', 'robot name="other"', "name: other instead of body"),
        (f'link name="{LINK}"', 'link name="x"', "links: ['base', 'x', "),
        (f'joint name="{JOINT}"', 'joint name="x"', "joints: ['x', "),
        ('mass value="0.003"', 'mass value="0.0031"', f"mass of '{LINK}': [0.0031] instead of "),
        ('ixx="[^"]*"', 'ixx="0.1"', "inertia of 'base': [0.1, "),
        ('xyz="0 0 [^"]*" rpy', 'xyz="0 0 1" rpy', "centre of mass of 'base': [0, 0, 1] "),
        ('(<inertial>\\s*<origin[^/]*)rpy="0 0 0"', '\\1rpy="0.1 0 0"', "axes of the inertia of "),
        ('type="revolute"', 'type="continuous"', f"type of '{JOINT}': continuous instead of rev"),
        ('parent link="base"', f'parent link="{LINK}"', f"parent and child of '{JOINT}': "),
        ('axis xyz="1 0 0"', 'axis xyz="0 1 0"', f"axis of '{JOINT}': [0, 1, 0] instead of [1, "),
        (
            '(</?child[^>]*>\\s*<origin) xyz="0 0 [^"]*"',
            '\\1 xyz="0 1 0"',
            f"origin of '{JOINT}': ",
        ),
        ('(</?child[^>]*>\\s*<origin[^/]*)rpy="0 0 0"', '\\1rpy="0 0 1"', f"rotation of '{JOINT}'"),
        ('upper="3"', 'upper="2"', f"limits of '{JOINT}': [-3, 2, 10, 20] instead of [-3, 3, "),
        ('effort="10"', 'effort="1"', f"limits of '{JOINT}': [-3, 3, 1, 20] instead of "),
        ("<limit[^>]*/>", "", f"limits of '{JOINT}' are None"),
        ('damping="0.001"', 'damping="0.002"', f"damping of '{JOINT}': [0.002] instead of "),
        ('friction="0"', 'friction="1"', f"friction of '{JOINT}': [1] instead of [0]"),
        ("<dynamics[^>]*/>", "", f"no damping and friction of '{JOINT}'"),
        ("<mass[^>]*/>", "", "mass of 'base': [none] instead of "),
        ("<inertial>.*?</inertial>", "", "no inertial of 'base'"),
    ],
)
def test_a_difference_is_found(chain: Chain, pattern: str, replacement: str, reason: str) -> None:
    text, count = re.subn(pattern, replacement, render(chain), count=1, flags=re.DOTALL)
    assert count == 1
    assert refusal(text, chain).startswith(reason)


def test_several_differences_are_said() -> None:
    for count, more in ((2, ""), (5, ""), (8, "; and 3 more")):
        chain = chain_of(manipulator(actuator(count, X)))
        text = render(chain).replace('friction="0"', 'friction="1"')
        said = [
            f"friction of 'actuator_0_joint_0{place}': [1] instead of [0]"
            for place in range(1, min(count, 5) + 1)
        ]
        assert refusal(text, chain) == "; ".join(said) + more


def test_a_tip_frame_needs_a_name_of_its_own(chain: Chain) -> None:
    assert refusal(render(chain, "base"), chain) == "two links are called 'base'"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("origin", (0.0, 0.0, 0.030000001)),
        ("axis", (1.0, 1e-8, 0.0)),
        ("upper", 3.00000001),
        ("lower", 4.0),
        ("damping", 0.00100000001),
    ],
)
def test_another_chain_is_refused(chain: Chain, name: str, value: Any) -> None:
    joint = dataclasses.replace(chain.joints[0], **{name: value})
    other = dataclasses.replace(chain, joints=(joint, *chain.joints[1:]))
    assert refusal(render(chain), other)


def with_extra(text: str) -> Callable[[Chain], str]:
    return lambda chain: render(chain).replace("</robot>", f"{text}</robot>")


TIP = '<link name="t"/><joint name="j" type="{}"><parent link="{}"/><child link="t"/></joint>'


@pytest.mark.parametrize(
    ("extra", "reason"),
    [
        (TIP.format("fixed", "base"), "place of 'j': ('fixed', 'base') instead of "),
        (TIP.format("continuous", "actuator_0_segment_02"), "place of 'j': ('continuous', "),
        (
            '<link name="t"><inertial><mass value="1"/></inertial></link>',
            "link 't' has a mass, and the chain has no such link",
        ),
    ],
)
def test_more_than_a_tip_frame_is_refused(chain: Chain, extra: str, reason: str) -> None:
    assert refusal(with_extra(extra)(chain), chain).startswith(reason)


def test_poses_are_compared_by_the_other_programs_own_kinematics(
    chain: Chain, monkeypatch: pytest.MonkeyPatch
) -> None:
    from somo_cli.manipulator import urdf_readback

    real = urdf_readback.kinematics.link_poses

    def bent_the_other_way(chain: Chain, angles: list[float], base: Any) -> Any:
        return real(chain, [-angle for angle in angles], base)

    monkeypatch.setattr(urdf_readback.kinematics, "link_poses", bent_the_other_way)
    reason = refusal(render(chain), chain)
    assert "orientation of 'actuator_0_segment_01', bent" in reason
    assert "position of 'actuator_0_segment_02', bent" in reason
