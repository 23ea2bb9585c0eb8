"""How well a chain of few joints follows the uniform beam of the same tip stiffness.

Lengths are relative to that of the beam; forces and frequencies are such that EI and mass are 1.
The beam is clamped, slender and inextensible; the links of the chain are slender rods.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import root

from somo_cli.analysis.closed_forms import tip_load
from somo_cli.arrays import Array
from somo_cli.calibration.moment_arms import MomentArms
from somo_cli.manipulator.definition import Placement

_FIRST = {"bending": 1.875104068711961**2, "torsion": math.pi / 2}
"""First natural frequency of a beam with a clamped and a free end.

Blevins, Formulas for Natural Frequency and Mode Shape (1979).
"""

_STATIONS = 401  # along the length


@dataclass(frozen=True, slots=True)
class BeamComparison:
    """Errors of a chain that has the tip stiffness of the beam, as ratios: 0.01 is one per cent.

    `profile`, shape (11,), holds the errors of the deflection under a force on the tip at tenths of
    the length, relative to the deflection of the tip (torsion: of the angle under a moment);
    `along` is the largest such error anywhere. `moment` and `weight` are the errors of the tip
    deflection under an end moment and under the weight of the beam; `large` is the distance
    of the tip from that of the elastica under a dead load P L² / EI = 1, over the length. These
    three are nan for torsion. `frequency` is the error of the first natural frequency, `top` the
    ratio of the highest to the first, on which the largest explicit time step depends.
    """

    moment_arms: MomentArms
    placement: Placement
    along: float
    profile: Array
    moment: float
    weight: float
    large: float
    frequency: float
    top: float


def compare_with_beam(moment_arms: MomentArms, placement: Placement) -> BeamComparison:
    """Return the errors of a chain whose stiffness gives the tip stiffness of the beam exactly."""
    arms = moment_arms.arms[moment_arms.arms > 0]
    places = moment_arms.places[: len(arms)] / moment_arms.at
    rigid = (
        moment_arms.rigidity(moment_arms.tip_stiffness(1.0)) / moment_arms.at
    )  # EI / a for a stiffness of 1
    stiffness = (moment_arms.profile / moment_arms.shares)[: len(arms)] / rigid
    lowest, highest = _frequencies(moment_arms, places, stiffness)
    errors = _errors_along(moment_arms, places, stiffness)
    is_bending = moment_arms.kind == "bending"
    return BeamComparison(
        moment_arms=moment_arms,
        placement=placement,
        along=float(np.abs(errors).max()),
        profile=errors[:: (_STATIONS - 1) // 10],
        moment=_tip_deflection(places, stiffness, 0) * 2 - 1 if is_bending else math.nan,
        weight=_tip_deflection(places, stiffness, 2) * 4 - 1 if is_bending else math.nan,
        large=_elastica_distance(places, stiffness) if is_bending else math.nan,
        frequency=lowest / _FIRST[moment_arms.kind] - 1,
        top=highest / lowest,
    )


def compare_placements(
    build: Callable[[int, Placement], MomentArms], counts: Iterable[int]
) -> Iterator[BeamComparison]:
    """Yield the errors of chains with `counts` joints, evenly placed and at Gauss points."""
    for count in counts:
        for placement in ("uniform", "gauss"):
            yield compare_with_beam(build(count, placement), placement)


def _tip_deflection(places: Array, stiffness: Array, power: int) -> float:
    """Return the deflection of the tip under a moment (1 - s)^power along the beam."""
    arms = 1 - places
    return float(np.sum(arms**power / stiffness * arms))


def _errors_along(moment_arms: MomentArms, places: Array, stiffness: Array) -> Array:
    """Return the deflection of chain minus beam at even stations, over that of the tip."""
    s = np.linspace(0, 1, _STATIONS)
    beyond = s[:, np.newaxis] - places
    if moment_arms.kind == "torsion":
        # a link between two joints has one angle, so the error is largest at its ends
        twist: Array = (beyond > 0) @ (1 / stiffness) - s
        return twist
    chain = np.maximum(beyond, 0) @ ((1 - places) / stiffness)
    beam = s * s * (3 - s) / 6  # Timoshenko, Strength of Materials I (1955), sec. 32
    errors: Array = 3 * (chain - beam)
    return errors


def _elastica_distance(places: Array, stiffness: Array) -> float:
    """Return the distance of the tip from that of the elastica under P L² / EI = 1, over length."""
    links = np.diff(np.append(places, 1.0))

    def shape(angles: Array) -> tuple[Array, Array]:
        slopes = np.cumsum(angles)
        return links * np.cos(slopes), links * np.sin(slopes)

    def unbalance(angles: Array) -> Array:
        along, _ = shape(angles)
        arms = np.cumsum(along[::-1])[::-1]  # of a force across the clamp
        rest: Array = stiffness * angles - arms
        return rest

    found = root(unbalance, (1 - places) / stiffness, method="hybr", options={"xtol": 1e-13})
    along, across = shape(found.x)
    return math.dist((places[0] + along.sum(), across.sum()), tip_load(1.0))


def _frequencies(moment_arms: MomentArms, places: Array, stiffness: Array) -> tuple[float, float]:
    """Return the lowest and the highest natural frequency about the straight pose, total mass 1."""
    last = np.maximum.outer(places, places)
    free = 1 - last  # length that both joints move
    mass = free
    if moment_arms.kind == "bending":
        # the integral of (s - x_i)(s - x_j) from the later joint to the tip
        apart = np.abs(np.subtract.outer(places, places))
        mass = free**3 / 3 + apart * free**2 / 2
    # with many joints only the largest eigenvalue is accurate, so each end has its own problem
    flexible = eigh(mass / np.sqrt(np.outer(stiffness, stiffness)), eigvals_only=True)
    squares = eigh(np.diag(stiffness), mass, eigvals_only=True)
    return 1 / math.sqrt(flexible[-1]), math.sqrt(squares[-1])
