"""A manipulator cut anew: what stays, what changes, and what cannot be cut."""

from __future__ import annotations

import pytest

from somo_cli.manipulator.resegmentation import NotUniform, cut, per_joint
from tests.builders.definitions import BOX, SPHERE, X, Y, actuator, compiled, hinge, manipulator

TWO = manipulator(actuator(10, X, Y), actuator(4, hinge(1, 0, 0, joint_neutral_position=0.1)))


def test_cut_into_as_many_segments_it_stays_what_it_is() -> None:
    one = compiled(manipulator(actuator(10, X, Y)))
    assert cut(one, 10) == one


@pytest.mark.parametrize("count", [2, 5, 20, 40])
def test_length_mass_and_rigidity_stay(count: int) -> None:
    before = compiled(TWO)
    after = cut(before, count)
    assert len(after.chain.joints) == 2 * count
    assert after.chain.length == pytest.approx(before.chain.length)
    masses = [sum(link.inertial.mass for link in one.chain.links) for one in (before, after)]
    assert masses[1] == pytest.approx(masses[0])
    for name in ("stiffness", "damping"):
        rigidity = {(j.actuator, j.channel): getattr(j, name) * j.span for j in before.chain.joints}
        for joint in after.chain.joints:
            expected = rigidity[joint.actuator, joint.channel]
            assert getattr(joint, name) * joint.span == pytest.approx(expected)
    neutral = [joint.neutral_position / joint.span for joint in before.chain.joints]
    assert after.chain.joints[-1].neutral_position / after.chain.joints[-1].span == pytest.approx(
        neutral[-1]
    )
    assert after.chain.joints[0].upper / after.chain.joints[0].span == pytest.approx(
        before.chain.joints[0].upper / before.chain.joints[0].span
    )


def test_equal_angles_keep_the_curvature() -> None:
    before = compiled(TWO)
    after = cut(before, 20)
    angles = [0.1 if joint.actuator == 0 else 0.2 for joint in before.chain.joints]
    found = per_joint(angles, before, after)
    assert found == pytest.approx([0.05] * 20 + [0.04] * 20)
    assert sum(found) == pytest.approx(sum(angles))


def test_angles_that_differ_cannot_be_spread() -> None:
    before = compiled(manipulator(actuator(4, X)))
    with pytest.raises(NotUniform, match="along axis 0 of actuator 0"):
        per_joint([0.1, 0.1, 0.2, 0.1], before, cut(before, 8))


@pytest.mark.parametrize(
    ("definition", "count", "message"),
    [
        (
            manipulator(actuator(2, X, hinge(1, 0, 0, spring_stiffness=0.5), planar_flag=2)),
            4,
            "joints of actuator 0 differ",
        ),
        (manipulator(actuator(4, X, link=SPHERE)), 8, "spheres"),
        (manipulator(actuator(4, X, Y)), 1, "2 axes"),
    ],
)
def test_what_cannot_be_cut(definition: dict[str, object], count: int, message: str) -> None:
    with pytest.raises(NotUniform, match=message):
        cut(compiled(definition), count)


def test_a_declared_inertia_gives_way() -> None:
    link = {**BOX, "inertial_values": [3e-7, 0, 0, 3e-7, 0, 3e-7]}
    one = compiled(manipulator(actuator(4, X, link=link)))
    assert cut(one, 4).definition.actuators[0].link.inertia is None
