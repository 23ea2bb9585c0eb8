"""Read the camera and the size of a picture from options."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

from somo_cli.cli.application import require

if TYPE_CHECKING:
    from somo_cli.picture.camera import View
    from somo_cli.picture.draw import PictureSettings

MAX_PIXELS = 4096  # across or down


def look_of(camera: str, target: str | None, size: str, is_even: bool) -> PictureSettings:
    """Return the settings of --camera, --target and --size; `is_even` requires even sizes."""
    from somo_cli.picture.draw import PictureSettings

    width, _, height = size.partition("x")
    is_size = all(part.isascii() and part.isdigit() for part in (width, height))
    require(
        is_size and all(16 <= int(part) <= MAX_PIXELS for part in (width, height)),
        "--size",
        f"{size!r} is not two numbers of pixels from 16 to {MAX_PIXELS}, such as 960x720",
    )
    pixels = (int(width), int(height))
    is_fit = not (is_even and any(number % 2 for number in pixels))
    require(is_fit, "--size", f"{size} is odd, and an .mp4 needs even numbers")
    view = _view(camera)
    if target is not None:
        x, y, z = _numbers(target, "--target", (3,))
        view = dataclasses.replace(view, target=(x, y, z))
    return PictureSettings(view, pixels)


def _view(camera: str) -> View:
    from somo_cli.picture.camera import VIEWS, View

    if camera in VIEWS:
        return VIEWS[camera]
    known = f"{camera!r} is not one of {', '.join(VIEWS)}, nor YAW,PITCH or YAW,PITCH,DISTANCE"
    require("," in camera, "--camera", known)
    numbers = _numbers(camera, "--camera", (2, 3))
    require(
        abs(numbers[1]) <= 90,
        "--camera",
        f"a pitch of {numbers[1]:g} is not from -90 to 90 degrees",
    )
    distance = numbers[2] if len(numbers) == 3 else None
    require(
        distance is None or distance > 0,
        "--camera",
        f"a distance of {distance} m is not greater than 0",
    )
    return View(math.radians(numbers[0]), math.radians(numbers[1]), distance)


def _numbers(text: str, option: str, counts: tuple[int, ...]) -> tuple[float, ...]:
    try:
        numbers = tuple(map(float, text.split(",")))
    except ValueError:
        numbers = ()
    is_right = len(numbers) in counts and all(map(math.isfinite, numbers))
    count = " or ".join(map(str, counts))
    require(is_right, option, f"{text!r} is not {count} numbers separated by commas")
    return numbers
