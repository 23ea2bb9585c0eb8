"""On what the turn of the cube depends: friction, stiffness, torque, each changed by itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from tests.studies.in_hand_turn import FINGERS, STEP, Turn, joint, setting, turns

CYCLES = 5
# those of the scene: N·m per psi in a chamber; and of finger.yaml: N·m/rad, N·m/Pa, N·m·s/rad
SIDE = 0.0024
STIFFNESS, SIDE_STIFFNESS = 0.117045, 0.41033125
TORQUE = 4.88195372e-07
DAMPING, SIDE_DAMPING = 0.00045, 0.00072

Sets = Sequence[str]


def friction_of_fingers(value: float) -> Sets:
    """Return what changes the friction of all fingers; that on the cube is 1.2 times as large."""
    return tuple(f"{finger}.surface.friction={value!r}" for finger in FINGERS)


def friction_of_palm(value: float) -> Sets:
    """Return what changes the friction of palm and pads; that on the cube is 1.2 times as large."""
    return tuple(f"objects[{number}].friction={value!r}" for number in (0, 2, 3, 4, 5))


def side_torque(per_psi: float) -> Sets:
    """Return what changes the torque [N·m] about y for a psi in either chamber."""
    sets = []
    for number, finger in enumerate(FINGERS):
        mix = [0.0] * 8
        mix[2 * number], mix[2 * number + 1] = per_psi, -per_psi
        sets.append(f"{finger}.actuation[1].mix={mix}")
    return tuple(sets)


def damping(part: float) -> Sets:
    """Return what changes the damping of all joints."""
    both = (
        joint(0, "spring_damping", part * DAMPING),
        joint(1, "spring_damping", part * SIDE_DAMPING),
    )
    return (*both[0], *both[1])


def palm_raised(by: float) -> Sets:
    """Return what raises palm and pads [m]."""
    pads = [f"objects[{number}].position[2]={0.08 + by!r}" for number in (2, 3, 4, 5)]
    return (f"objects[0].position[2]={0.0799 + by!r}", *pads)


# by name, and by the value over that of the scene
FACTORS: Mapping[str, Mapping[float, Sets]] = {
    "torque aside": {part: side_torque(part * SIDE) for part in (0.7, 1.3)},
    "torque per pressure": {
        part: joint(0, "torque_per_pressure", part * TORQUE) for part in (0.8, 1.2)
    },
    "stiffness inwards": {
        part: joint(0, "spring_stiffness", part * STIFFNESS) for part in (0.8, 1.2)
    },
    "stiffness aside": {
        part: joint(1, "spring_stiffness", part * SIDE_STIFFNESS) for part in (0.8, 1.2)
    },
    "friction of fingers": {part: friction_of_fingers(part) for part in (0.5, 0.75, 1.5, 3.0)},
    "friction of palm": {part: friction_of_palm(0.15 * part) for part in (0.5, 2.0)},
    "damping": {part: damping(part) for part in (0.33, 3.0)},
    "mass of cube": {5.0: ("objects[1].mass=0.05",)},
}
# what has no such factor
OTHERS: Mapping[str, Sets] = {
    "palm 3 mm higher": palm_raised(0.003),
    "palm 3 mm lower": palm_raised(-0.003),
    # a patch of contact of 4.5 mm, evenly pressed, resists a spin as a ring of 2/3 of its radius
    "fingers' spinning friction 3 mm": tuple(
        f"{finger}.surface.spinning_friction=0.003" for finger in FINGERS
    ),
}


@dataclass(frozen=True, slots=True)
class Opened:
    """The scene as it is, and with something changed: by name and factor, None where none."""

    base: Turn
    runs: Mapping[tuple[str, float | None], Turn]

    def table(self) -> Iterator[str]:
        """Yield the table of what the turn depends on."""
        base = self.base.per_cycle
        yield f"{CYCLES} cycles at {1e3 * STEP:g} ms; as shipped {base:.2f} ° a cycle"
        yield "changed                          factor  a cycle [°]  of the scene's"
        for (name, part), run in self.runs.items():
            factor = "-" if part is None else f"{part:g}"
            lost = "" if len(run.cycles) == CYCLES else f"  lost after {run.times[-1]:.1f} s"
            change = 100 * (run.per_cycle / base - 1)
            yield f"{name:33}{factor:>6}{run.per_cycle:13.2f}{change:+14.0f} %{lost}"

    def rates(self) -> dict[str, dict[float, float]]:
        """Return the turn a cycle [°] by name and factor."""
        found: dict[str, dict[float, float]] = {}
        for (name, part), run in self.runs.items():
            if part is not None:
                found.setdefault(name, {1.0: self.base.per_cycle})[part] = run.per_cycle
        return found


def run_open(processes: int | None = None) -> Opened:
    """Run the scene with other values of what is open."""
    changes: dict[tuple[str, float | None], Sets] = {
        (name, part): sets for name, parts in FACTORS.items() for part, sets in parts.items()
    }
    changes |= {(name, None): sets for name, sets in OTHERS.items()}
    settings = [setting(*sets, cycles=CYCLES) for sets in ((), *changes.values())]
    base, *runs = turns(settings, processes)
    return Opened(base, dict(zip(changes, runs, strict=True)))
