"""Opens pictures that users and data name: a list of formats, and a limit of pixels that is checked before decoding.

Libraries for pictures know many more formats; some of them start another program (Pillow passes PostScript to
Ghostscript) or expand a small file to gigabytes. Every picture is opened by `decode_picture` or `open_with_pillow`.
"""

from __future__ import annotations

import contextlib
import io
import struct
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any, BinaryIO, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError, ObjectNavError

FORMATS = ("PNG", "JPEG", "WebP", "BMP", "GIF")
MAX_PIXELS = 64_000_000
"""Pixels of the largest picture that is decoded."""
_PILLOW = threading.Lock()


class PictureHeader(NamedTuple):
    """What the first bytes of a picture say about it."""

    kind: str
    """One of `FORMATS`."""
    width_px: int
    height_px: int


def image_size_px(content: bytes) -> tuple[int, int] | None:
    """Returns width and height of a picture from its header; None if its format is not one of `FORMATS`."""
    header = read_header(content)
    return None if header is None else (header.width_px, header.height_px)


def read_header(content: bytes) -> PictureHeader | None:
    """Returns format and size of a picture; None if its format is not one of `FORMATS` or its header is broken."""
    try:
        if content[:8] == b"\x89PNG\r\n\x1a\n" and content[12:16] == b"IHDR":
            return PictureHeader("PNG", *struct.unpack(">II", content[16:24]))
        if content[:2] == b"\xff\xd8":
            return _jpeg_header(content)
        if content[:4] == b"RIFF" and content[8:12] == b"WEBP":
            return _webp_header(content)
        if content[:2] == b"BM":
            return _bmp_header(content)
        if content[:4] == b"GIF8":
            return PictureHeader("GIF", *struct.unpack("<HH", content[6:10]))
    except (struct.error, IndexError):
        pass
    return None


def require_small_image(content: bytes, *, where: str, error: type[ObjectNavError] = ConfigError) -> PictureHeader:
    """Returns format and size of a picture.

    Raises:
        ObjectNavError: of class `error`; its format is not one of `FORMATS`, or it has more than `MAX_PIXELS` pixels.
    """
    header = read_header(content)
    if header is None:
        raise error(f"{where} has an unsupported format; use {', '.join(FORMATS)}.")
    _require_size(header.width_px, header.height_px, where, error)
    return header


def decode_picture(
    content: bytes, flag: int = cv2.IMREAD_COLOR, *, where: str, error: type[ObjectNavError] = ConfigError
) -> NDArray[Any]:
    """Returns the pixels of a picture (h, w, *channels), channels in OpenCV's order.

    Args:
        content: of its file.
        flag: how OpenCV decodes it.
        where: name of the picture for the error message, for example "Picture 'a.png'".
        error: class of the error.

    Raises:
        ObjectNavError: of class `error`; it has another format, is too large or is damaged.
    """
    require_small_image(content, where=where, error=error)
    try:
        picture = cv2.imdecode(np.frombuffer(content, np.uint8), flag)
    except cv2.error:
        picture = None
    if picture is None:
        raise error(f"{where} is damaged and cannot be read.")
    return picture


@contextlib.contextmanager
def limited_pillow(refused: Callable[[str], None]) -> Iterator[None]:
    """Makes Pillow open the formats and sizes of this module only, for libraries that call `Image.open` themselves.

    Args:
        refused: gets a sentence on each picture that was not opened; the library gets the error, too.
    """
    import PIL.Image

    original = PIL.Image.open

    def limited(stream: BinaryIO, *_args: object, **_options: object) -> Any:
        content = stream.read() if hasattr(stream, "read") else b""
        try:
            header = require_small_image(content, where="A picture")
            picture = original(io.BytesIO(content), formats=(header.kind.upper(),))
            _require_size(*picture.size, "A picture", ConfigError)  # Pillow may take another header of the file
        except (ConfigError, OSError, ValueError, SyntaxError, PIL.Image.DecompressionBombError) as fault:
            refused(str(fault) if isinstance(fault, ConfigError) else "A picture is damaged and cannot be read.")
            raise
        return picture

    with _PILLOW:
        PIL.Image.open = limited
        try:
            yield
        finally:
            PIL.Image.open = original


def jpeg_of(picture: NDArray[Any], quality: int) -> bytes:
    """Returns an RGB picture, uint8 (h, w, 3), as a JPEG file of this quality, 0 to 100."""
    written, jpeg = cv2.imencode(".jpg", np.ascontiguousarray(picture[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert written
    return jpeg.tobytes()


def tiled(pictures: Sequence[NDArray[np.uint8]], columns: int) -> NDArray[np.uint8]:
    """Returns one picture that shows pictures of the same size (h, w, 3) in a grid, row by row.

    Raises:
        ConfigError: the list is empty.
    """
    if not pictures:
        raise ConfigError("There are no pictures to show.")
    tiles = [*pictures, *[np.full_like(pictures[0], 255)] * (-len(pictures) % columns)]
    return np.vstack([np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)])


def _require_size(width_px: int, height_px: int, where: str, error: type[ObjectNavError]) -> None:
    if width_px * height_px > MAX_PIXELS:
        raise error(
            f"{where} has {width_px} x {height_px} pixels; at most {MAX_PIXELS // 1_000_000} million are allowed."
        )


def _jpeg_header(content: bytes) -> PictureHeader | None:
    position = 2
    while position + 9 <= len(content) and content[position] == 0xFF:
        while position + 10 <= len(content) and content[position + 1] == 0xFF:
            position += 1  # a marker may follow any number of fill bytes
        marker, length = content[position + 1], int.from_bytes(content[position + 2 : position + 4], "big")
        if marker == 0x01 or 0xD0 <= marker <= 0xD7:  # these markers have no length
            position += 2
            continue
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width = struct.unpack(">HH", content[position + 5 : position + 9])
            return PictureHeader("JPEG", width, height)
        position += 2 + max(length, 1)
    return None


def _webp_header(content: bytes) -> PictureHeader | None:
    chunk = content[12:16]
    if chunk == b"VP8X":
        width, height = (1 + int.from_bytes(content[at : at + 3], "little") for at in (24, 27))
    elif chunk == b"VP8L":
        (bits,) = struct.unpack("<I", content[21:25])
        width, height = 1 + (bits & 0x3FFF), 1 + (bits >> 14 & 0x3FFF)
    elif chunk == b"VP8 ":
        width, height = (side & 0x3FFF for side in struct.unpack("<HH", content[26:30]))
    else:
        return None
    return PictureHeader("WebP", width, height)


def _bmp_header(content: bytes) -> PictureHeader:
    if content[14:18] == b"\x0c\0\0\0":  # the header of OS/2
        return PictureHeader("BMP", *struct.unpack("<HH", content[18:22]))
    width, height = struct.unpack("<ii", content[18:26])
    return PictureHeader("BMP", abs(width), abs(height))
