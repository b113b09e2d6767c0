"""Pictures are opened in few formats and within a limit of pixels; none starts another program."""

from __future__ import annotations

import ast
import io
from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.core import pictures
from sim.core.errors import ConfigError

ROOT = Path(__file__).parents[3]
OPENERS = {"imdecode", "imread", "imdecodemulti", "imreadmulti"}
IMAGE = np.random.default_rng(0).integers(0, 255, (30, 50, 3), np.uint8)


@pytest.mark.parametrize("kind", [".png", ".jpg", ".webp", ".bmp", ".gif"])
def test_a_picture_of_each_format_is_decoded_and_its_size_is_read_before(kind: str) -> None:
    content = cv2.imencode(kind, IMAGE)[1].tobytes()
    assert pictures.image_size_px(content) == (50, 30)
    assert pictures.decode_picture(content, where="Picture").shape == (30, 50, 3)
    for length in range(0, 40):
        with pytest.raises(ConfigError):
            pictures.decode_picture(content[:length], where="Picture")


def test_other_formats_are_refused_with_the_list_of_formats() -> None:
    for kind in (".tiff", ".pgm"):
        content = cv2.imencode(kind, IMAGE[..., 0].copy())[1].tobytes()
        with pytest.raises(ConfigError, match="unsupported format; use PNG, JPEG, WebP, BMP, GIF"):
            pictures.decode_picture(content, where="Picture")


def test_pillow_opens_only_these_formats_and_sizes_while_it_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    pillow = pytest.importorskip("PIL.Image")
    large, losses = io.BytesIO(), Counter[str]()
    pillow.new("RGB", (50, 30)).save(large, "PNG")
    small = large.getvalue()
    eps = io.BytesIO()
    pillow.new("RGB", (50, 30)).save(eps, "EPS")
    before = pillow.open
    with pictures.limited_pillow(lambda sentence: losses.update([sentence])):
        assert pillow.open(io.BytesIO(small)).size == (50, 30)
        with pytest.raises(ConfigError, match="unsupported format"):
            pillow.open(io.BytesIO(eps.getvalue()))
        monkeypatch.setattr(pictures, "MAX_PIXELS", 1000)
        with pytest.raises(ConfigError, match="50 x 30 pixels"):
            pillow.open(io.BytesIO(small))
    assert pillow.open is before
    assert losses.total() == 2


@pytest.mark.costly
def test_tiled_pictures_are_in_row_order() -> None:
    sheet = pictures.tiled([np.full((2, 3, 3), i, np.uint8) for i in range(5)], columns=2)
    assert sheet.shape == (6, 6, 3)
    assert sheet[2, 3, 0] == 3
    assert sheet[5, 5, 0] == 255
    with pytest.raises(ConfigError, match="no pictures"):
        pictures.tiled([], columns=0)


def test_pictures_are_decoded_in_one_place() -> None:
    found = {
        str(file.relative_to(ROOT))
        for package in ("sim", "stubborn")
        for file in (ROOT / package).rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.Attribute) and node.attr in OPENERS
    }
    assert found == {"sim/core/pictures.py"}
