"""Blocked force with angles of any size, against energy and the rule of small angles."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.calibration.blocked_force import blocked_equilibrium
from somo_cli.calibration.moment_arms import of_definition
from somo_cli.manipulator.chain_build import build_chain
from somo_cli.manipulator.definition import Definition
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from tests.builders.definitions import Data, X, Y, Z, actuator, compiled, hinge, manipulator

OFFSET = hinge(1, 0, 0, neutral_axis_offset=[0, 0.006, 0, 0, 0, 0])


def definition_of(data: Data) -> Definition:
    return compiled(manipulator(data)).definition


BODIES = {
    "planar": actuator(5, Y),
    "two axes": actuator(10, OFFSET, Y),
    "gauss": actuator(6, X, Y, joint_placement="gauss"),
}


@pytest.mark.parametrize("name", BODIES)
def test_a_small_force_follows_the_rule_of_small_angles(name: str) -> None:
    definition = definition_of(BODIES[name])
    known = of_definition(definition, 0, 0)
    found = blocked_equilibrium(definition, 0, 0, known, 1e-5)
    assert found is not None
    assert found.torque == pytest.approx(known.torque(1e-5), rel=1e-5)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("part", [1.0, 0.8])
def test_the_pose_minimises_energy_and_the_point_is_held(name: str, part: float) -> None:
    definition = definition_of(BODIES[name])
    known = of_definition(definition, 0, 0, part * 0.02 * definition.actuators[0].n_segments)
    force = 0.3 / known.length
    found = blocked_equilibrium(definition, 0, 0, known, force)
    assert found is not None
    assert np.abs(found.angles).max() > 0.1
    alone = build_chain(dataclasses.replace(definition, base=None, tips=()))
    body = ChainDynamics(alone)
    straight = body.at(np.zeros(body.count))
    link = int(np.sum(straight.origins[1:, 2] < known.at))
    local = np.array((0, 0, known.at)) - straight.origins[link]
    across = np.cross(known.direction, (0, 0, 1))
    drives = np.array([joint.channel == 0 for joint in alone.joints])

    def potential(angles: np.ndarray) -> float:
        pose = body.at(angles)
        work = found.torque * angles[drives].sum() - force * pose.point(link, local) @ across
        return pose.elastic_energy() - float(work)

    steps = 1e-5 * np.eye(body.count)
    slopes = [
        (potential(found.angles + step) - potential(found.angles - step)) / 2e-5 for step in steps
    ]
    assert np.abs(slopes).max() < 1e-8 * abs(found.torque) / 1e-2
    assert body.at(found.angles).point(link, local) @ across == pytest.approx(0, abs=1e-12)


def test_a_force_that_nothing_can_hold_has_no_torque() -> None:
    definition = definition_of(actuator(5, X))
    known = of_definition(definition, 0, 0)
    assert blocked_equilibrium(definition, 0, 0, known, 1e4) is None


def test_without_springs_there_is_no_equilibrium() -> None:
    definition = definition_of(actuator(5, hinge(1, 0, 0, spring_stiffness=0)))
    assert blocked_equilibrium(definition, 0, 0, of_definition(definition, 0, 0), 1.0) is None


def test_no_force_takes_no_torque() -> None:
    definition = definition_of(actuator(5, X))
    found = blocked_equilibrium(definition, 0, 0, of_definition(definition, 0, 0), 0.0)
    assert found is not None
    assert (found.torque, np.abs(found.angles).max()) == (0, 0)


def test_for_torsion_there_is_no_equilibrium_to_solve() -> None:
    definition = definition_of(actuator(4, Z))
    assert blocked_equilibrium(definition, 0, 0, of_definition(definition, 0, 0), 1.0) is None
