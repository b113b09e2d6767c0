"""Reads the text of MJCF files in any usual encoding, and replaces each `include` by the content of its file.

MuJoCo gets one text without `include`, so that it reads exactly the text that was checked. By itself, MuJoCo would also
open `<Include>`, files in zip archives and, for some names, files of the current folder.
"""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass, field

from sim.core.reading import without_mark

_DECLARED = re.compile(rb"""\s*<\?xml[^>]{0,200}?\bencoding\s*=\s*["']([A-Za-z][\w.:-]{0,40})["']""")
_USUAL = re.compile(
    r"utf-8\S*|ascii|iso8859-\d+|cp\d+|mac-\w+|koi8-\w+|gb2312|gbk|gb18030|big5\w*|euc_\w+|shift_jis\w*|tis-620|utf-(?:16|32)\S*"
)
"""The encodings that are read, by Python's names; others, such as UTF-7, can hide characters or decode slowly."""
_TAG = re.compile(rb"""<[^>"']*(?:(?:"[^"]*"|'[^']*')[^>"']*)*>""")
"""A tag of well-formed XML."""


def as_utf8(content: bytes) -> bytes:
    """Returns the text of an XML file as UTF-8; its encoding is that of its byte order mark or its declaration.

    Raises:
        ValueError: the encoding is not allowed, or the bytes are not valid in it.
    """
    content = without_mark(content)
    for start, encoding in ((b"<\0", "utf-16-le"), (b"\0<", "utf-16-be")):
        if content.startswith(start):
            return content.decode(encoding).encode("utf-8")
    declaration = _DECLARED.match(content)
    if declaration is None:
        return _checked(content)
    declared = declaration[1].decode()
    try:
        name = codecs.lookup(declared).name
    except LookupError:
        name = ""
    if not _USUAL.fullmatch(name):
        raise ValueError(f"its encoding '{declared}' is not read; save it as UTF-8")
    if name.startswith(("utf-", "ascii")):  # "utf-16" here: a program converted the text but not its declaration
        return _checked(content)
    return content.decode(name).encode("utf-8")


def _checked(content: bytes) -> bytes:
    content.decode("utf-8")
    return content


@dataclass
class Composition:
    """The text of one file while it is parsed, with the position of its root and the replacements of its includes."""

    content: bytes
    """The file, UTF-8."""
    root: list[int] = field(default_factory=list)
    """Positions of the content of the root element: its first byte and, once the end tag is known, its end."""
    _pieces: list[tuple[int, int, bytes]] = field(default_factory=list)

    def end_of_tag(self, start: int) -> tuple[int, bool]:
        """Returns the end of the tag that begins at a byte, and whether the tag is a complete element (`<x/>`)."""
        tag = _TAG.match(self.content, start)
        end = len(self.content) if tag is None else tag.end()
        return end, self.content[end - 2 : end] == b"/>"

    def open_root(self, start: int) -> None:
        """Stores the position of the start tag of the root element."""
        end, is_whole = self.end_of_tag(start)
        self.root = [end, end] if is_whole else [end]

    def close_root(self, start: int) -> None:
        """Stores the position of the end tag of the root element."""
        self.root = self.root if len(self.root) == 2 else [*self.root, start]

    def replace(self, start: int, end: int, text: bytes) -> None:
        """Replaces the bytes from `start` to `end`, an element, by a text."""
        self._pieces.append((start, end, text))

    def text(self, *, inner: bool) -> bytes:
        """Returns the text with all replacements; with `inner`, only the content of the root element."""
        begin, last = self.root if inner else (0, len(self.content))
        parts: list[bytes] = []
        for start, end, text in self._pieces:
            parts += (self.content[begin:start], text)
            begin = end
        return b"".join((*parts, self.content[begin:last]))
