"""Films, as another program reads them."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from somo_cli.picture import film

SIZE = (64, 48)
HEADS = {".mp4": b"ftyp", ".gif": b"GIF89a"}


def pictures(count: int) -> list[np.ndarray]:
    """Return pictures in which a bright square goes from left to right."""
    found = np.full((count, SIZE[1], SIZE[0], 3), 40, np.uint8)
    for number, picture in enumerate(found):
        picture[16:32, 4 * number : 4 * number + 16] = (240, 200, 120)
    return list(found)


# seen in imageio-ffmpeg 0.8.1: its reader leaves its pipes to the garbage collector
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("kind", film.KINDS)
def test_a_film_has_its_pictures_in_order_at_their_rate(tmp_path: Path, kind: str) -> None:
    encoder = pytest.importorskip("imageio_ffmpeg")
    content = film.encode(iter(pictures(10)), SIZE, Fraction(20), kind)
    assert HEADS[kind] in content[:12]
    path = tmp_path / f"film{kind}"
    path.write_bytes(content)
    reader = encoder.read_frames(str(path))
    about = next(reader)
    assert about["size"] == SIZE
    assert about["fps"] == pytest.approx(20)
    frames = [np.frombuffer(one, np.uint8).reshape(SIZE[1], SIZE[0], 3) for one in reader]
    assert len(frames) == 10
    for frame, picture in zip(frames, pictures(10), strict=True):
        assert np.abs(frame.astype(int) - picture).mean() < 4


@pytest.mark.parametrize("kind", film.KINDS)
def test_the_same_pictures_give_the_same_bytes(kind: str) -> None:
    pytest.importorskip("imageio_ffmpeg")
    one, two = (film.encode(pictures(3), SIZE, Fraction(25), kind) for _ in range(2))
    assert one == two


def test_what_is_broken_off_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def broken() -> object:
        yield from pictures(3)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        film.encode(broken(), SIZE, Fraction(25), ".mp4")  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []
