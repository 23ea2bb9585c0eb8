"""PNG files, as another reader has them."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import pytest

from somo_cli.picture.png import png


@pytest.mark.parametrize("shape", [(1, 1, 3), (7, 5, 3), (64, 128, 3)])
def test_another_reader_sees_the_same_pixels(shape: tuple[int, int, int]) -> None:
    image = pytest.importorskip("PIL.Image")
    pixels = np.random.default_rng(0).integers(0, 256, shape).astype(np.uint8)
    with image.open(BytesIO(png(pixels))) as read:
        assert (read.format, read.mode, read.size) == ("PNG", "RGB", (shape[1], shape[0]))
        read.verify()
    with image.open(BytesIO(png(pixels))) as read:
        assert np.array_equal(np.array(read), pixels)


def test_the_same_pixels_give_the_same_bytes() -> None:
    pixels = np.arange(300, dtype=np.uint8).reshape(10, 10, 3)
    assert png(pixels) == png(pixels.copy())
    assert b"tIME" not in png(pixels)
