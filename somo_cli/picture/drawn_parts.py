"""The solids of a scene that are drawn, and their poses in a configuration, in SI."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.manipulator.solids import Box
from somo_cli.picture.facets import Array, Facets, facets
from somo_cli.scene.model import Scene
from somo_cli.scene.placement import with_heights


@dataclass(frozen=True, slots=True)
class Configuration:
    """Joint angles [rad] and base pose [m] of each manipulator, and the pose of each object [m]."""

    angles: tuple[Sequence[float], ...]
    bases: tuple[Pose, ...]
    objects: tuple[Pose, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """A solid of a link of a body; bodies are manipulators, followed by objects.

    `facets` are in the frame of the solid, `pose` is that frame in the frame of the link, `colour`
    is red, green and blue from 0 to 1. The camera frames the parts with `is_framed`. A box may have
    a face coplanar with the end of a rounding beside it, and is then drawn in front of it.
    """

    body: int
    link: int
    facets: Facets
    pose: Pose
    colour: tuple[float, float, float]
    is_framed: bool
    is_box: bool = False


def start_configuration(scene: Scene) -> Configuration:
    """Return the configuration of a scene at its start."""
    return Configuration(
        tuple(one.initial_angles for one in scene.manipulators),
        tuple(one.pose for one in scene.manipulators),
        tuple(one.pose for one in with_heights(scene.objects, scene.ground)),
    )


def parts_of(scene: Scene) -> tuple[Part, ...]:
    """Return all parts to draw but the ground, body by body; fixed objects are not framed."""
    found = [
        _part(number, link, shape, is_framed=True)
        for number, one in enumerate(scene.manipulators)
        for link, of_link in enumerate(one.compiled.chain.links)
        for shape in of_link.shapes
    ]
    found += [
        _part(number, 0, shape, is_framed=not one.is_fixed)
        for number, one in enumerate(scene.objects, start=len(scene.manipulators))
        for shape in one.chain.links[0].shapes
    ]
    return tuple(found)


def poses_at(scene: Scene, parts: Sequence[Part], configuration: Configuration) -> tuple[Pose, ...]:
    """Return the pose of every part in the world [m]."""
    links = [
        link_poses(one.compiled.chain, angles, base)
        for one, angles, base in zip(
            scene.manipulators, configuration.angles, configuration.bases, strict=True
        )
    ]
    links += [(pose,) for pose in configuration.objects]
    return tuple(links[part.body][part.link].compose(part.pose) for part in parts)


def framed_points(parts: Sequence[Part], poses: Sequence[Pose]) -> Array:
    """Return the corners of boxes around all framed parts, in the world [m], shape (n, 3)."""
    return np.concatenate(
        [
            _corners(part.facets) @ np.array(pose.rotation).T + pose.position
            for part, pose in zip(parts, poses, strict=True)
            if part.is_framed
        ]
    )


def _part(body: int, link: int, shape: Shape, is_framed: bool) -> Part:
    pose = Pose.of(shape.position, shape.rpy)
    red, green, blue, _ = shape.material.rgba
    surface = facets(shape.solid).scaled(shape.visual_factor)
    is_box = isinstance(shape.solid, Box)
    return Part(body, link, surface, pose, (red, green, blue), is_framed, is_box)


def _corners(surface: Facets) -> Array:
    """Return the corners of the box around facets, shape (8, 3), in their frame."""
    ends = np.stack([surface.vertices.min(axis=0), surface.vertices.max(axis=0)])
    x, y, z = np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")
    return np.stack([ends[x.ravel(), 0], ends[y.ravel(), 1], ends[z.ravel(), 2]], axis=1)
