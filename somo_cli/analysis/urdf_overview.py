"""A URDF at a glance: its links and joints as a tree, with masses, limits, springs and dampers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from somo_cli.analysis.overview import Entry, Fact
from somo_cli.manipulator.urdf import is_scaled
from somo_cli.problems import InvalidFile, Problem
from somo_cli.scene.urdf_joints import elements_by_name
from somo_cli.scene.urdf_values import numbers
from somo_cli.scene.urdf_xml import XmlElement, parse_xml

MAX_BRANCHES = 100
"""The most branches, each on another, of a tree that is shown."""

_SPRINGS = (("springStiffness", "stiffness"), ("springReference", "neutral_position"))


def urdf_overview(text: str, source: str) -> Entry:
    """Return a URDF at a glance, in the units of the file: SI, unless it is at a world scale.

    A chain of links is a list, in which each has its own line; parts of a link that has several
    joints are its branches. Raises InvalidFile for what is no URDF of one tree.
    """
    return _Robot(text, source).entry()


class _Robot:
    """The links of a URDF, its joints by parent, and the springs that Gazebo's tags give."""

    def __init__(self, text: str, source: str) -> None:
        self._problems: list[Problem] = []
        self._texts = {source: text}
        self._is_scaled = is_scaled(text)
        self._shown = 0
        self._root = parse_xml(text, source)
        if self._root.tag != "robot":
            message = f"a URDF starts with <robot>, not with <{self._root.tag}>"
            raise InvalidFile([Problem(self._root.span, message)], self._texts)
        self._links = elements_by_name(self._problems, self._root, "link")
        self._joints = elements_by_name(self._problems, self._root, "joint")
        self._springs = _springs(self._problems, self._root)
        self._below: dict[str, list[str]] = {name: [] for name in self._links}
        self._children: dict[str, str] = {}
        for name, joint in self._joints.items():
            self._connect(name, joint)

    def _connect(self, name: str, joint: XmlElement) -> None:
        ends = [joint.first_child_with_tag(one) for one in ("parent", "child")]
        parent, child = ("" if one is None else one.attributes.get("link", "") for one in ends)
        unknown = [one for one in (parent, child) if one not in self._links]
        if unknown:
            message = f"joint '{name}' names '{unknown[0]}', which is not a link"
            self._problems.append(Problem(joint.span, message))
        elif child in self._children.values():
            self._problems.append(Problem(joint.span, f"link '{child}' has two parents"))
        else:
            self._below[parent].append(name)
            self._children[name] = child

    def entry(self) -> Entry:
        """Return the tree. Raises InvalidFile."""
        masses = {name: self._mass(link) for name, link in self._links.items()}
        moved = set(self._children.values())
        roots = [name for name in self._links if name not in moved]
        if not self._problems and len(roots) != 1:
            message = f"there are {len(roots)} links without a parent, where a tree has one"
            self._problems.append(Problem(self._root.span, message))
        parts = [] if self._problems else list(self._branch(roots[0], masses, 1))
        if not self._problems and self._shown < len(self._joints):
            message = "some links are their own ancestors: connect all links to one root link"
            self._problems.append(Problem(self._root.span, message))
        if self._problems:
            raise InvalidFile(self._problems, self._texts)
        movable = sum(one.attributes.get("type") != "fixed" for one in self._joints.values())
        total = sum(masses.values())
        words = f"{len(self._links)} links, {movable} joints that move, {total:.4g} kg"
        words += "; not in SI, but at the world scale that its first comment says" * self._is_scaled
        facts: dict[str, Fact] = {
            "links": len(self._links),
            "moving_joints": movable,
            "mass_kg": total,
            "is_in_si": not self._is_scaled,
        }
        base = masses[roots[0]]
        root = Entry(f"link {roots[0]}", f"{base:.4g} kg", {"mass_kg": base})
        return Entry(self._root.attributes.get("name", "robot"), words, facts, [root, *parts])

    def _branch(self, link: str, masses: Mapping[str, float], depth: int) -> Iterator[Entry]:
        """Yield what hangs on a link, without recursion along a chain."""
        while len(self._below[link]) == 1:
            (name,) = self._below[link]
            link = self._children[name]
            yield self._joint(name, link, masses[link])
        if self._below[link] and depth > MAX_BRANCHES:
            message = f"more than {MAX_BRANCHES} branches on branches are not shown"
            self._problems.append(Problem(self._links[link].span, message))
            return
        for name in self._below[link]:
            child = self._children[name]
            own = self._joint(name, child, masses[child])
            yield Entry(own.name, own.text, own.facts, list(self._branch(child, masses, depth + 1)))

    def _joint(self, name: str, child: str, mass: float) -> Entry:
        self._shown += 1
        joint = self._joints[name]
        kind = joint.attributes.get("type", "without a type")
        facts: dict[str, Fact] = {"type": kind, "child": child, "mass_kg": mass}
        words = [kind]
        if kind != "fixed":
            about = self._axis(joint)
            facts["axis"] = about
            words = [f"{kind} about ({', '.join(f'{one:g}' for one in about)})"]
            words += self._values(name, joint, kind, facts)
        return Entry(f"joint {name}", f"{', '.join(words)}; link {child}, {mass:.4g} kg", facts)

    def _values(
        self, name: str, joint: XmlElement, kind: str, facts: dict[str, Fact]
    ) -> Iterator[str]:
        """Yield limits, spring and damper in words; add them to the facts."""
        turn = "" if kind == "prismatic" else "·m"
        unit = "m" if kind == "prismatic" else "rad"
        own = self._springs.get(name, {})
        if "stiffness" in own:
            facts["stiffness"] = own["stiffness"]
            facts["neutral_position"] = own.get("neutral_position", 0.0)
            yield f"spring {own['stiffness']:.4g} N{turn}/{unit}"
        dynamics = joint.first_child_with_tag("dynamics")
        if dynamics is not None:
            (facts["damping"],) = numbers(self._problems, dynamics, "damping", 1, "0")
            yield f"damping {facts['damping']:.4g} N{turn}·s/{unit}"
        limit = joint.first_child_with_tag("limit")
        if limit is not None and kind != "continuous":
            ends = [numbers(self._problems, limit, end, 1, "0")[0] for end in ("lower", "upper")]
            facts["limits"] = ends
            yield f"from {ends[0]:.4g} to {ends[1]:.4g} {unit}"

    def _axis(self, joint: XmlElement) -> Sequence[float]:
        axis = joint.first_child_with_tag("axis")
        return (1.0, 0.0, 0.0) if axis is None else numbers(self._problems, axis, "xyz", 3)

    def _mass(self, link: XmlElement) -> float:
        inertial = link.first_child_with_tag("inertial")
        mass = None if inertial is None else inertial.first_child_with_tag("mass")
        return 0.0 if mass is None else numbers(self._problems, mass, "value", 1)[0]


def _springs(problems: list[Problem], root: XmlElement) -> dict[str, dict[str, float]]:
    """Return stiffness and neutral position of each joint to which a tag of Gazebo gives them."""
    found: dict[str, dict[str, float]] = {}
    for element in root.children_with_tag("gazebo"):
        own = found.setdefault(element.attributes.get("reference", ""), {})
        for tag, name in _SPRINGS:
            one = element.first_child_with_tag(tag)
            if one is not None:
                own[name] = _number(problems, one)
    return found


def _number(problems: list[Problem], element: XmlElement) -> float:
    try:
        return float(element.text)
    except ValueError:
        message = f"<{element.tag}> is '{element.text}', not a number"
        problems.append(Problem(element.span, message))
        return 0.0
