"""PNG files: the same bytes for the same pixels, on one platform."""

from __future__ import annotations

import struct
import zlib

from somo_cli.picture.facets import Array

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_RGB = 2
_UP = 2  # the filter that stores the difference to the line above


def png(pixels: Array) -> bytes:
    """Return the PNG of pixels, unsigned bytes of shape (height, width, 3)."""
    height, width, _ = pixels.shape
    lines = pixels.reshape(height, 3 * width)
    above = lines.copy()
    above[0], above[1:] = 0, lines[:-1]
    content = b"".join(bytes([_UP]) + line.tobytes() for line in lines - above)  # modulo 256
    head = struct.pack(">IIBBBBB", width, height, 8, _RGB, 0, 0, 0)
    parts = ((b"IHDR", head), (b"IDAT", zlib.compress(content, 9)), (b"IEND", b""))
    return _SIGNATURE + b"".join(_chunk(kind, data) for kind, data in parts)


def _chunk(kind: bytes, data: bytes) -> bytes:
    checksum = zlib.crc32(kind + data)
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checksum)
