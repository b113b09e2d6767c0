"""Reads files that users, other programs or earlier runs wrote: it checks types and sizes, and names each fault.

The types are those of msgspec: a `msgspec.Struct` names the fields that a file must have and their types, and the
aliases below bound numbers and names. JSON has no NaN and no infinity here, nesting and size are limited, and a
message names the file, the line, the field, the value and the expected type.
"""

from __future__ import annotations

import codecs
import csv
import gzip
import hashlib
import io
import itertools
import os
import re
import stat
import struct
import tarfile
import unicodedata
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, BinaryIO, Generic, NamedTuple, TypeVar

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from sim.core.errors import ConfigError, ObjectNavError

T = TypeVar("T")
Json = dict[str, "Json"] | list["Json"] | str | int | float | bool | None
"""Any value of JSON."""
MAX_BYTES = 64 << 20
"""Largest JSON file that is read, also after decompression; the largest that ships has 0.3 MB."""
MAX_LINES_BYTES = 512 << 20
"""Largest file of lines (`results.jsonl`): about 700,000 episodes."""
MAX_EMPTY_LINES = 10_000
"""A small compressed file can have billions of them."""
MAX_TAR_HEADER_BYTES = 2048
"""Largest extended header of a member of a tar file; the time of `tarfile` grows with the square of its size."""
_TAR_EXTENSIONS = (
    tarfile.XHDTYPE, tarfile.XGLTYPE, tarfile.SOLARIS_XHDTYPE, tarfile.GNUTYPE_LONGNAME, tarfile.GNUTYPE_LONGLINK
)  # fmt: skip
_ALIKE = {"LATIN", "CYRILLIC", "GREEK", "ARMENIAN", "CHEROKEE"}
"""Alphabets with letters of the same shape."""
_UNSEEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Categories of characters that are invisible, change the direction of writing, or control a terminal."""
_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""The byte order marks that Windows programs write, with the encoding that follows."""

FARTHEST_M = 10_000.0
"""Largest coordinate or size."""
Metres = Annotated[float, Meta(ge=-FARTHEST_M, le=FARTHEST_M)]
"""A coordinate or a length."""
Number = Annotated[float, Meta(ge=-1e12, le=1e12)]
"""Any other measured number."""
Count = Annotated[int, Meta(ge=0, le=10**12)]
Seed = Annotated[int, Meta(ge=0, le=2**63 - 1)]
Name = Annotated[str, Meta(min_length=1, max_length=1000, pattern=r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]*\Z")]
"""An id or a name: text without control characters, which a terminal would interpret."""


_CHUNK_BYTES = 1 << 20
_LFS_POINTER = b"version https://git-lfs.github.com/spec/v"
"""What Git writes in place of a large file that was not downloaded begins with this."""


class Lines(NamedTuple, Generic[T]):
    """The lines of a file that grows while it is written."""

    values: list[T]
    whole_bytes: int
    """Length of the complete lines."""
    torn: str
    """A sentence on an incomplete last line, which was left out; "" if every line is complete."""


def open_plain(file: Path, *, what: str, error: type[ObjectNavError] = ConfigError) -> BinaryIO:
    """Returns a plain file, open for reading. It refuses a pipe, a device or a folder, and does not wait for a pipe.

    Every file that a user or data names is opened by this function.

    Args:
        file: the file.
        what: kind of the file for the error message, for example "Episode file".
        error: class of the error.

    Raises:
        ObjectNavError: of class `error`; the file does not exist, cannot be opened or is not a plain file.
    """
    try:
        return _open_plain(file)
    except (OSError, ValueError) as fault:
        raise error(f"{what} '{file}' cannot be read: {reason_of(fault)}.") from None


def _open_plain(file: Path) -> BinaryIO:
    """Returns a plain file, open for reading; raises OSError or ValueError."""
    # Without O_NONBLOCK, opening a pipe waits for a writer. A plain file does not have that flag.
    handle = os.open(file, os.O_RDONLY | os.O_CLOEXEC | getattr(os, "O_NONBLOCK", 0))
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise OSError("it is not a plain file")
    file_read = os.fdopen(handle, "rb")
    if file_read.peek(len(_LFS_POINTER)).startswith(_LFS_POINTER):
        file_read.close()
        raise OSError("it is a Git LFS pointer and not the file itself; run `git lfs pull` in its repository")
    return file_read


def read_bytes(file: Path, *, what: str, error: type[ObjectNavError] = ConfigError, most: int = MAX_BYTES) -> bytes:
    """Returns the content of a file.

    Args:
        file: the file.
        what: kind of the file for the error message, for example "Episode file".
        error: class of the error.
        most: largest number of bytes.

    Raises:
        ObjectNavError: of class `error`; the file does not exist, cannot be read or is too large.
    """
    with open_plain(file, what=what, error=error) as stream:
        try:
            content = _read_up_to(stream, most + 1)
        except OSError as fault:
            raise error(f"{what} '{file}' cannot be read: {reason_of(fault)}.") from None
    if len(content) > most:
        raise error(f"{what} '{file}' is too large: at most {most >> 20} MB are read.")
    return content


def _read_up_to(stream: BinaryIO, most: int) -> bytes:
    """Returns the rest of a stream, or its first `most` bytes; `read(most)` would allocate them all before it reads."""
    chunks, left = [], most
    while left and (chunk := stream.read(min(left, _CHUNK_BYTES))):
        chunks.append(chunk)
        left -= len(chunk)
    return b"".join(chunks)


def read_text(file: Path, *, what: str, error: type[ObjectNavError] = ConfigError, most: int = MAX_BYTES) -> str:
    """Returns the text of a file in UTF-8, or in the encoding of its byte order mark, as lines that end with "\\n".

    Raises:
        ObjectNavError: of class `error`; the file cannot be read, is too large or is not text in this encoding.
    """
    content = read_bytes(file, what=what, error=error, most=most)
    try:
        text = without_mark(content).decode("utf-8")
    except UnicodeError as fault:
        raise error(f"{what} '{file}' is not text in UTF-8: {reason_of(fault)}.") from None
    return text.replace("\r\n", "\n")


def read_csv(file: Path, *, what: str) -> list[dict[str, str]]:
    """Returns the rows of a CSV file by the names of its columns; the missing fields of a short row are "".

    Raises:
        ConfigError: the file cannot be read or is not a table.
    """
    try:
        table = csv.DictReader(io.StringIO(read_text(file, what=what), newline=""), restval="", restkey="")
        return [{key: value for key, value in row.items() if key} for row in table]
    except csv.Error as fault:
        raise ConfigError(f"{what} '{file}' is not a table: {reason_of(fault)}.") from None


def sha256_of(file: Path, *, what: str, error: type[ObjectNavError] = ConfigError) -> str:
    """Returns the SHA-256 of a file of any size, hexadecimal.

    Raises:
        ObjectNavError: of class `error`; the file cannot be read.
    """
    digest = hashlib.sha256()
    with open_plain(file, what=what, error=error) as stream:
        try:
            while block := stream.read(1 << 20):
                digest.update(block)
        except OSError as fault:
            raise error(f"{what} '{file}' cannot be read: {reason_of(fault)}.") from None
    return digest.hexdigest()


def without_mark(content: bytes) -> bytes:
    """Returns a text as UTF-8 without a byte order mark; text with the mark of UTF-16 is converted.

    Raises:
        UnicodeError: the text is not in the encoding of its mark.
    """
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            rest = content[len(mark) :]
            return rest if encoding == "utf-8" else rest.decode(encoding).encode("utf-8")
    return content


class PlainMember(tarfile.TarInfo):
    """A member of a tar file: `tarfile.open(..., tarinfo=PlainMember)` refuses large extended headers unread."""

    @classmethod
    def frombuf(cls, buf: bytes | bytearray, encoding: str, errors: str) -> PlainMember:
        """Returns the member of a header of 512 bytes.

        Raises:
            tarfile.TarError: it is not a header, or announces an extended header of more than `MAX_TAR_HEADER_BYTES`.
        """
        member = super().frombuf(buf, encoding, errors)
        if member.type in _TAR_EXTENSIONS and member.size > MAX_TAR_HEADER_BYTES:
            raise tarfile.ReadError(f"it has an extended header of {member.size} bytes")
        return member


def read_json(file: Path, kind: type[T] | Any, *, what: str, error: type[ObjectNavError] = ConfigError) -> T:
    """Returns the content of a JSON file as the declared type.

    Raises:
        ObjectNavError: of class `error`; the file cannot be read or has other content.
    """
    return parse_json(read_bytes(file, what=what, error=error), kind, where=f"{what} '{file}'", error=error)


def read_gzip_json(file: Path, kind: type[T] | Any, *, what: str, strict: bool = True) -> T:
    """Returns the content of a gzipped JSON file as the declared type; `strict` is that of `parse_json`.

    Raises:
        ConfigError: the file cannot be read, expands to more than `MAX_BYTES`, or has other content.
    """
    with open_plain(file, what=what) as packed:
        try:
            content = gzip.GzipFile(fileobj=packed).read(MAX_BYTES + 1)
        except (OSError, EOFError, zlib.error, struct.error, ValueError) as fault:
            raise ConfigError(f"{what} '{file}' cannot be read: {reason_of(fault)}.") from None
    if len(content) > MAX_BYTES:
        raise ConfigError(f"{what} '{file}' expands to more than {MAX_BYTES >> 20} MB.")
    return parse_json(content, kind, where=f"{what} '{file}'", strict=strict)


def read_lines(file: Path, kind: type[T], *, what: str, older: str = "") -> Lines[T]:
    """Returns the JSON objects of a file with one per line as the declared type.

    A process that is killed can leave a last line without its end; some file systems leave a last line of zero bytes
    after a power failure. Such a line is left out and described in `Lines.torn`.

    Args:
        file: it may be absent; there is no line then.
        kind: the type of a line.
        what: kind of the file for the error message.
        older: what the error message says where a line lacks a field, as in files of an older format.

    Raises:
        ConfigError: the file cannot be read, or a line before the last is broken.
    """
    if not file.exists():
        return Lines([], 0, "")
    content = read_bytes(file, what=what, most=MAX_LINES_BYTES)
    whole = content[: content.rfind(b"\n") + 1]
    rest = content[len(whole) :]
    values: list[T] = []
    for number, line in enumerate(whole.splitlines(), start=1):
        try:
            where = f"{what} '{file}', line {number}"
            values.append(parse_json(line, kind, where=where))
        except ConfigError as fault:
            if older and "missing required field" in str(fault):
                raise ConfigError(f"{str(fault).rstrip('.')}: {older}.") from None
            raise
    torn = f"{what} '{file}': the incomplete line {len(values) + 1} was dropped ({len(rest)} bytes)." if rest else ""
    return Lines(values, len(whole), torn)


class TextLine(NamedTuple):
    """A line of a file."""

    number: int
    """Number of the line, from 1."""
    text: bytes
    share: float
    """Share of the file, as it lies on the disk, that has been read up to here, in (0, 1]."""


def json_lines(file: Path, *, what: str) -> Iterator[TextLine]:
    """Yields the lines of a file, which may be gzipped; empty lines are left out.

    The file is read line by line, so that it may be of any size; a line has at most `MAX_BYTES`, and at most
    `MAX_EMPTY_LINES` lines are empty.

    Raises:
        ConfigError: the file cannot be read, or a line is too long.
    """
    with open_plain(file, what=what) as packed:
        zipped = packed.read(2) == b"\x1f\x8b"
        size = max(1, packed.seek(0, os.SEEK_END))
        packed.seek(0)
        stream = gzip.GzipFile(fileobj=packed) if zipped else packed
        empty = 0
        for number in itertools.count(1):
            try:
                line = stream.readline(MAX_BYTES + 1)
            except (OSError, EOFError, zlib.error, struct.error, ValueError) as fault:
                raise ConfigError(f"{what} '{file}', line {number} cannot be read: {reason_of(fault)}.") from None
            if len(line) > MAX_BYTES:
                raise ConfigError(f"{what} '{file}', line {number} is longer than {MAX_BYTES >> 20} MB.")
            if not line:
                return
            empty += not line.strip()
            if empty > MAX_EMPTY_LINES:
                raise ConfigError(f"{what} '{file}', line {number}: more than {MAX_EMPTY_LINES:,} lines are empty.")
            if line.strip():
                yield TextLine(number, line, min(1.0, packed.tell() / size))


def parse_json(
    content: bytes | str,
    kind: type[T] | Any,
    *,
    where: str,
    error: type[ObjectNavError] = ConfigError,
    strict: bool = True,
) -> T:
    """Returns JSON text as the declared type.

    Args:
        content: the text.
        kind: any type that msgspec knows.
        where: the file and line for the error message.
        error: class of the error.
        strict: False: an integer may be written as 3.0 or "3".

    Raises:
        ObjectNavError: of class `error`; the text is not JSON, nested too deeply, or of another type.
    """
    try:
        text = without_mark(content) if isinstance(content, bytes) else content
        return msgspec.json.decode(text, type=kind, strict=strict)
    except msgspec.ValidationError as fault:
        raise error(f"{where}{_fault(fault)}") from None
    except RecursionError:
        raise error(f"{where} is nested too deeply.") from None
    except (msgspec.DecodeError, UnicodeError) as fault:
        raw = content if isinstance(content, bytes) else content.encode(errors="replace")
        empty = not raw.strip(b"\0 \n\r\t")
        raise error(f"{where} is {'empty' if empty else f'not JSON: {fault}'}.") from None


def convert(
    value: Any, kind: type[T] | Any, *, where: str, error: type[ObjectNavError] = ConfigError, strict: bool = True
) -> T:
    """Returns a value of JSON's types as the declared type.

    Args:
        value: the value.
        kind: any type that msgspec knows.
        where: the file and line for the error message.
        error: class of the error.
        strict: False: numbers that are written as text, as in CSV, are allowed, too.

    Raises:
        ObjectNavError: of class `error`; it is of another type.
    """
    try:
        return msgspec.convert(value, kind, strict=strict)
    except (msgspec.ValidationError, OverflowError) as fault:
        raise error(f"{where}{_fault(fault)}") from None
    except RecursionError:
        raise error(f"{where} is nested too deeply.") from None


def require_small_zip(file: Path, *, what: str, most: int) -> None:
    """Raises ConfigError if a file is not a zip file (`.npz`, a PyTorch file), or expands to more than `most` bytes."""
    with open_plain(file, what=what) as stream:
        try:
            size = sum(member.file_size for member in zipfile.ZipFile(stream).infolist())
        except (OSError, ValueError, zipfile.BadZipFile, NotImplementedError, struct.error) as fault:
            raise ConfigError(f"{what} '{file}' cannot be read: {reason_of(fault)}.") from None
    if size > most:
        raise ConfigError(f"{what} '{file}' expands to {size >> 20} MB; at most {most >> 20} MB are read.")


def read_npz(
    file: Path | bytes,
    names: Iterable[str] | None = None,
    *,
    what: str,
    most_bytes: int,
    error: type[ObjectNavError] = ConfigError,
) -> dict[str, NDArray[Any]]:
    """Returns the arrays of an `.npz` file by name; pickled objects are refused.

    Args:
        file: the file, or its content.
        names: the arrays to read; the file must have all of them. None: all arrays of the file.
        what: kind of the file for the error message, for example "trajectory".
        most_bytes: largest size of all its arrays together.
        error: class of the error.

    Raises:
        ObjectNavError: of class `error`; the file cannot be read, is damaged or too large, or lacks an array.
    """
    try:
        opened = io.BytesIO(file) if isinstance(file, bytes) else _open_plain(file)
        with opened as stream, zipfile.ZipFile(stream) as archive:
            size = sum(member.file_size for member in archive.infolist())
            if size > most_bytes:
                raise ValueError(f"it expands to {size >> 20} MB; at most {most_bytes >> 20} MB are read")
            members = [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]
            requested = members if names is None else list(names)
            missing = next((name for name in requested if name not in members), None)
            if missing is not None:
                raise ValueError(f"it has no '{missing}'")
            return {name: _read_member(archive, name) for name in requested}
    except Exception as fault:  # damaged files raise many kinds of errors in zipfile and NumPy
        named = "This" if isinstance(file, bytes) else f"'{file}'"
        raise error(f"{named} is not a {what}: {reason_of(fault)}.") from None


def disguise_of(text: str) -> str:
    """Returns a phrase on why a text can look like another one; "": it cannot.

    Invisible characters and those that change the direction of writing are found, characters that are variants of
    others (Unicode's form NFKC), and words that mix the alphabets with letters of the same shape.
    """
    if any(unicodedata.category(letter) in (*_UNSEEN, "Cn", "Co") for letter in text):
        return "has an invisible character, or one that changes the direction of writing"
    if unicodedata.normalize("NFKC", text) != text:
        return f"has variants of characters; write '{ascii(unicodedata.normalize('NFKC', text))[1:-1]}'"
    for word in re.split(r"[\W\d_]+", text):
        alphabets = {unicodedata.name(letter, "").partition(" ")[0] for letter in word} & _ALIKE
        if len(alphabets) > 1:
            return f"has a word with letters of {' and '.join(sorted(name.title() for name in alphabets))}"
    return ""


def printable(text: str) -> str:
    """Returns text for a terminal: control and invisible characters and lone surrogates are written as escapes."""
    return "".join(
        letter if letter in "\n\t" or unicodedata.category(letter) not in _UNSEEN else _escape(letter)
        for letter in text
    )


def first_unprintable(words: Iterable[str]) -> str | None:
    """Returns the first word with a control character or a byte that is not UTF-8, or None."""
    return next((word for word in words if printable(word) != word or "\n" in word or "\t" in word), None)


def reason_of(fault: Exception) -> str:
    """Returns the reason of an error in a few words: the operating system's text, else the error's message."""
    if isinstance(fault, OSError) and fault.strerror:
        return fault.strerror
    return " ".join(str(fault).split()).rstrip(".") or type(fault).__name__


def _read_member(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """Returns one array of an open `.npz` file."""
    with archive.open(f"{name}.npy") as stream:
        return np.lib.format.read_array(stream, allow_pickle=False)


def _escape(letter: str) -> str:
    return letter.encode("unicode_escape", errors="backslashreplace").decode("ascii")


def _fault(fault: Exception) -> str:
    """Returns msgspec's message with the field before it: ", field 'episodes[...].goal': expected str, got int."."""
    message, _, path = str(fault).replace("`", "").partition(" - at ")
    path = re.sub(r"^(?:key in )?\$\.?", "", path)
    field = f", field '{path}'" if path else ""
    begins_with_word = re.match(r"[A-Z][a-z]*\b", message)  # a name such as SemExpConfig keeps its capital
    return f"{field}: {message[0].lower() + message[1:] if begins_with_word else message}".rstrip(".") + "."
