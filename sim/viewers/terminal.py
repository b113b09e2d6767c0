"""Shows pictures in a terminal as coloured half blocks and reads single keys, with the standard library and ANSI only.

A character cell holds two pixels, the upper one as the foreground of U+2580 and the lower one as its background.
"""

from __future__ import annotations

import os
import select
import sys
import termios
import tty
from collections.abc import Sequence
from types import TracebackType
from typing import Literal, TextIO

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.errors import ConfigError
from sim.invocation import program

Colours = Literal["true", "256"]
HALF_BLOCK = "\u2580"
RESET = "\x1b[0m"
ARROWS = {"A": "up", "B": "down", "C": "right", "D": "left"}
_ESCAPE_S = 0.05
"""The rest of an arrow key's sequence arrives within this time; nothing follows a single Escape key."""
_ENTER_SCREEN, _LEAVE_SCREEN = "\x1b[?1049h\x1b[?25l\x1b[2J", "\x1b[0m\x1b[?25h\x1b[?1049l"


def colours_of(environment: dict[str, str] | os._Environ[str]) -> Colours:
    """Returns the colours that the terminal supports; terminals with 24 bits set `COLORTERM`."""
    return "true" if environment.get("COLORTERM", "").lower() in ("truecolor", "24bit") else "256"


def half_blocks(image: NDArray[np.uint8], colours: Colours = "true") -> list[str]:
    """Returns lines of text that show an image.

    Args:
        image: RGB (2 n, m, 3), which gives n lines of m characters.
        colours: `true` for 24 bits, `256` for the fixed palette of older terminals.
    """
    lines = []
    for upper, lower in zip(image[0::2].tolist(), image[1::2].tolist(), strict=True):
        parts: list[str] = []
        shown = None
        for pair in zip(upper, lower, strict=True):
            if pair != shown:
                parts.append(_paint(pair[0], pair[1], colours))
                shown = pair
            parts.append(HALF_BLOCK)
        lines.append("".join(parts) + RESET)
    return lines


def fitted(image: NDArray[np.uint8], columns: int, lines: int) -> NDArray[np.uint8]:
    """Returns an image at the largest size that fits into columns and lines, with its proportions; rows are even."""
    scale = min(columns / image.shape[1], 2 * lines / image.shape[0])
    width, height = max(1, int(image.shape[1] * scale)), max(1, round(image.shape[0] * scale / 2)) * 2
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def beside(blocks: Sequence[Sequence[str]], widths: Sequence[int], gap: int = 2) -> list[str]:
    """Returns blocks of lines next to each other; shorter blocks are filled with spaces below."""
    height = max(len(block) for block in blocks)
    return [
        (" " * gap).join(
            block[i] if i < len(block) else " " * width for block, width in zip(blocks, widths, strict=True)
        )
        for i in range(height)
    ]


class Terminal:
    """A context manager that takes over the terminal of this process."""

    def __init__(self, keys: TextIO | None = None, screen: TextIO | None = None) -> None:
        """Reads keys from one stream and draws on another (standard input and output).

        Raises:
            ConfigError: one of them is not a terminal.
        """
        self._keys, self._screen = keys or sys.stdin, screen or sys.stdout
        if not (self._keys.isatty() and self._screen.isatty()):
            raise ConfigError(f"{program()} needs a terminal: standard input and output must not be a file or a pipe.")
        self.colours: Colours = colours_of(os.environ)

    def __enter__(self) -> Terminal:
        self._before = termios.tcgetattr(self._keys.fileno())
        tty.setcbreak(self._keys.fileno())  # keys arrive immediately and without echo; Ctrl-C still interrupts
        self._write(_ENTER_SCREEN)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._write(_LEAVE_SCREEN)
        termios.tcsetattr(self._keys.fileno(), termios.TCSADRAIN, self._before)

    @property
    def size(self) -> tuple[int, int]:
        """Current number of columns and lines."""
        columns, lines = os.get_terminal_size(self._screen.fileno())
        return columns, lines

    def show(self, lines: Sequence[str]) -> None:
        """Draws lines from the top and clears the rest of the screen."""
        self._write("\x1b[H" + "\r\n".join(f"{line}\x1b[K" for line in lines) + "\x1b[J")

    def key(self) -> str:
        """Waits for a key and returns a character, or `up`, `down`, `left`, `right`; "" when the terminal is gone."""
        character = self._read()
        if character != "\x1b" or not self._waiting():
            return character
        opening = self._read()  # [ or O
        last = self._read()
        while opening == "[" and (last.isdigit() or last == ";") and self._waiting():  # modifiers, function keys
            last = self._read()
        return ARROWS.get(last, "?unknown")

    def _read(self) -> str:
        return os.read(self._keys.fileno(), 1).decode(errors="replace")

    def _waiting(self) -> bool:
        return bool(select.select([self._keys.fileno()], [], [], _ESCAPE_S)[0])

    def _write(self, text: str) -> None:
        self._screen.write(text)
        self._screen.flush()


def _paint(upper: Sequence[int], lower: Sequence[int], colours: Colours) -> str:
    if colours == "true":
        return "\x1b[38;2;{};{};{};48;2;{};{};{}m".format(*upper, *lower)
    return f"\x1b[38;5;{_index_of_256(upper)};48;5;{_index_of_256(lower)}m"


def _index_of_256(rgb: Sequence[int]) -> int:
    """Returns the nearest colour of xterm's 6 x 6 x 6 cube, or of its greys for a colour that is nearly grey."""
    if max(rgb) - min(rgb) < 12:
        level = (sum(rgb) // 3 - 8) // 10
        return 16 if level < 0 else 231 if level > 23 else 232 + level
    red, green, blue = (0 if v < 48 else 1 if v < 115 else (v - 35) // 40 for v in rgb)
    return 16 + 36 * red + 6 * green + blue
