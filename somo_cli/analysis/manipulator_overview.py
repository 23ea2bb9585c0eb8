"""A manipulator at a glance: its actuators and axes, what they weigh, how stiff they are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from somo_cli.analysis.overview import Entry, Fact
from somo_cli.manipulator.chain import Chain, Joint, Limb, Link
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import natural_frequencies

MODES = 3  # that are told

_AXES = (("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z, torsion", (0, 0, 1)))


def manipulator_overview(name: str, chain: Chain) -> Entry:
    """Return a chain at a glance; in SI if the chain is.

    Its parts are its limbs, if it is an assembly, with their actuators, and its slowest modes about
    the neutral position, with the base held and without gravity.
    """
    mass = sum(link.inertial.mass for link in chain.links)
    base = chain.links[0].inertial.mass
    text = (
        f"{_count(len(chain.links), 'link')}, {_count(len(chain.joints), 'joint')}, "
        f"{mass:.4g} kg, of which {base:.4g} kg the base; {chain.length:.4g} m long"
    )
    facts = {
        "links": len(chain.links),
        "joints": len(chain.joints),
        "mass_kg": mass,
        "base_mass_kg": base,
        "length_m": chain.length,
    }
    parts: list[Entry] = []
    for limb in chain.backbones:
        own = list(_actuators(chain, limb))
        parts += [_limb(chain, limb, own)] if limb.name else own
    return Entry(name, text, facts, [*parts, *_modes(chain)])


def _limb(chain: Chain, limb: Limb, actuators: Sequence[Entry]) -> Entry:
    mass = _mass(chain.links[limb.first + 1 : limb.last + 1])
    text = f"{_count(limb.last - limb.first, 'joint')}, {mass:.4g} kg beyond the body"
    facts = {"joints": limb.last - limb.first, "mass_kg": mass}
    return Entry(f"limb {limb.name}", text, facts, actuators)


def _actuators(chain: Chain, limb: Limb) -> Iterator[Entry]:
    joints = list(enumerate(chain.joints))[limb.first : limb.last]
    for number in sorted({joint.actuator for _, joint in joints}):
        own = [(index, joint) for index, joint in joints if joint.actuator == number]
        mass = _mass([chain.links[index + 1] for index, _ in own])
        channels = sorted({joint.channel for _, joint in own})
        length = sum(joint.span for _, joint in own if joint.channel == channels[0])
        yield Entry(
            f"actuator {number - limb.first_actuator}",
            f"{_count(len(own), 'joint')} over {length:.4g} m, {mass:.4g} kg",
            {"joints": len(own), "length_m": length, "mass_kg": mass},
            [_axis(one, [joint for _, joint in own if joint.channel == one]) for one in channels],
        )


def _axis(channel: int, joints: Sequence[Joint]) -> Entry:
    stiffness = [joint.stiffness for joint in joints]
    damping = [joint.damping for joint in joints]
    whole = 1 / sum(1 / one for one in stiffness) if all(stiffness) else 0.0
    about = next((name for name, axis in _AXES if joints[0].axis == axis), str(joints[0].axis))
    limits = (
        f"from {joints[0].lower:.4g} to {joints[0].upper:.4g} rad"
        if joints[0].is_limited
        else "without limits"
    )
    text = (
        f"{_count(len(joints), 'joint')} about {about}, each {_range(stiffness)} N·m/rad "
        f"({whole:.4g} in series), damping {_range(damping)} N·m·s/rad, {limits}"
    )
    facts: dict[str, Fact] = {
        "joints": len(joints),
        "about": about,
        "stiffness_nm_per_rad": stiffness,
        "stiffness_in_series_nm_per_rad": whole,
        "damping_nm_s_per_rad": damping,
        "neutral_position_rad": [joint.neutral_position for joint in joints],
    }
    return Entry(f"axis {channel}", text, facts)


def _modes(chain: Chain) -> Iterator[Entry]:
    if not chain.joints:
        return
    dynamics = ChainDynamics(chain)
    mass = dynamics.at(chain.neutral_angles).joint_inertia()
    try:
        found = natural_frequencies(mass, dynamics.stiffness)
    except np.linalg.LinAlgError:
        yield Entry("modes", "none: the inertia of the joints is singular", {})
        return
    slowest = [float(one) / math.tau for one in found[:MODES]]
    text = ", ".join(f"{one:.4g}" for one in slowest) + " Hz, base held, without gravity"
    yield Entry("slowest modes", text, {"frequencies_hz": slowest})


def _mass(links: Sequence[Link]) -> float:
    return sum(link.inertial.mass for link in links)


def _range(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:.4g}" if high - low <= 1e-9 * abs(high) else f"{low:.4g} to {high:.4g}"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun if number == 1 else noun + 's'}"
