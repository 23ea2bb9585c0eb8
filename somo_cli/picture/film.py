"""Films from pictures; no other module uses the encoder."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

from somo_cli.picture.facets import Array
from somo_cli.problems import ExtraMissing

KINDS = (".mp4", ".gif")
MAX_GIF_RATE = 50
"""Pictures per second, the most of a GIF, whose times are hundredths of a second."""

_BARE = ["-threads", "1", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1"]
_PALETTE = "split[one][two];[one]palettegen[colours];[two][colours]paletteuse=dither=sierra2_4a"
_SETTINGS: dict[str, dict[str, Any]] = {
    ".mp4": {"codec": "libx264", "quality": 7, "macro_block_size": 2, "output_params": _BARE},
    ".gif": {
        "codec": "gif",
        "quality": None,
        "pix_fmt_out": "pal8",
        "macro_block_size": 1,
        "output_params": [*_BARE, "-vf", _PALETTE],
    },
}


def require() -> None:
    """Raise ExtraMissing if the encoder is not installed."""
    _encoder()


def encode(pictures: Iterable[Array], size: tuple[int, int], rate: Fraction, kind: str) -> bytes:
    """Return a film of pictures, unsigned bytes of shape (height, width, 3), `rate` per second.

    `size` is width and height, both even for an .mp4. Raises ExtraMissing, or OSError if the
    encoder fails.
    """
    encoder = _encoder()
    with tempfile.TemporaryDirectory(prefix="somo-") as folder:
        path = Path(folder) / f"film{kind}"
        writer = encoder.write_frames(
            str(path), size, fps=float(rate), ffmpeg_log_level="error", **_SETTINGS[kind]
        )
        try:
            writer.send(None)
            for picture in pictures:
                writer.send(picture.tobytes())
        finally:
            writer.close()
        return path.read_bytes()


def _encoder() -> Any:
    missing = ExtraMissing("films need imageio-ffmpeg: pip install 'somo-cli[film]'")
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise missing from error
    try:
        imageio_ffmpeg.get_ffmpeg_exe()
    except RuntimeError as error:  # no binary for this platform or on the path
        raise missing from error
    return imageio_ffmpeg
