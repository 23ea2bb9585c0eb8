"""Read the joints of a URDF that describes one rigid body, and place its links."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import Problem
from somo_cli.scene.urdf_values import origin_of, report
from somo_cli.scene.urdf_xml import XmlElement


def elements_by_name(problems: list[Problem], root: XmlElement, tag: str) -> dict[str, XmlElement]:
    """Return the elements of this tag below the root by name; report missing and repeated names."""
    found: dict[str, XmlElement] = {}
    for element in root.children_with_tag(tag):
        name = element.attributes.get("name")
        if name is None:
            report(problems, element, f"this {tag} has no name")
        elif name in found:
            report(problems, element, f"there is another {tag} '{name}'")
        else:
            found[name] = element
    return found


def link_poses(
    problems: list[Problem], root: XmlElement, links: Mapping[str, XmlElement]
) -> dict[str, Pose]:
    """Return the pose of every link in the frame of the root link, in the order of `links`.

    Reports an error for joints that do not connect the links to one tree. The result omits links
    that are not connected to the root link, and is empty unless there is exactly one root link.
    """
    joints = _joints_by_child(problems, root, links)
    root_link = _root_link(problems, root, links, joints)
    if root_link is None:
        return {}
    poses = {root_link: Pose()}
    waiting = dict(joints)
    while waiting:
        ready = [child for child, joint in waiting.items() if joint.parent in poses]
        if not ready:
            in_loop = links[next(iter(waiting))]
            report(
                problems,
                in_loop,
                "this link is its own ancestor",
                "connect all links to one root link",
            )
            break
        for child in ready:
            joint = waiting.pop(child)
            poses[child] = poses[joint.parent].compose(joint.pose)
    return {name: poses[name] for name in links if name in poses}


class _Joint(NamedTuple):
    """The parent link of a joint, and the pose of the child link in the frame of the parent."""

    parent: str
    pose: Pose


def _joints_by_child(
    problems: list[Problem], root: XmlElement, links: Mapping[str, XmlElement]
) -> dict[str, _Joint]:
    """Return the joint of each child link; report joints that are not fixed or not of a tree."""
    joints: dict[str, _Joint] = {}
    for element in root.children_with_tag("joint"):
        name = element.attributes.get("name", "")
        _require_fixed(problems, element, name)
        parent, child = _linked_name(element, "parent"), _linked_name(element, "child")
        unknown = [one for one in (parent, child) if one not in links]
        if unknown:
            known = f"the links are {', '.join(links) or 'none'}"
            report(
                problems,
                element,
                f"joint '{name}' names '{unknown[0]}', which is not a link",
                known,
            )
        elif child in joints:
            report(problems, element, f"link '{child}' has two parents")
        else:
            joints[child] = _Joint(parent, origin_of(problems, element))
    return joints


def _require_fixed(problems: list[Problem], joint: XmlElement, name: str) -> None:
    kind = joint.attributes.get("type", "")
    if kind != "fixed":
        hint = "an object is one rigid body: make the joint fixed, or define a manipulator"
        message = f"joint '{name}' is {kind}, not fixed" if kind else f"joint '{name}' has no type"
        report(problems, joint, message, hint)


def _linked_name(joint: XmlElement, end: str) -> str:
    """Return the name of the link at the `end` of a joint, parent or child; empty without one."""
    element = joint.first_child_with_tag(end)
    return element.attributes.get("link", "") if element else ""


def _root_link(
    problems: list[Problem],
    root: XmlElement,
    links: Mapping[str, XmlElement],
    joints: Mapping[str, _Joint],
) -> str | None:
    """Return the only link without a parent; if it is not unique, report it and return None."""
    roots = [name for name in links if name not in joints]
    if len(roots) == 1:
        return roots[0]
    if problems:  # an earlier error may be the cause
        return None
    if roots:
        message = f"there are {len(roots)} links without a parent: {', '.join(roots)}"
    else:
        message = "every link has a parent" if links else "the URDF has no link"
    report(problems, root, message, "connect all links to one root link")
    return None
