"""Liblouis, where it is installed: the library that embossers and screen readers translate with, and its tables.

It is called by ctypes. What PyPI has under the name `louis` is something else.
"""

import ctypes
import sys
from functools import cache
from threading import Lock
from typing import Any, NamedTuple

from tangible_core.errors import BrailleError, quoted

from .cells import Cells

TABLES = {"en": "en-ueb-g1.ctb", "de": "de-g0.utb", "fr": "fr-bfu-comp6.utb"}
"""Uncontracted: Unified English Braille, German Basisschrift, French Braille uniformisé."""
NAMES = {
    "linux": ("liblouis.so.20", "liblouis.so"),
    "darwin": ("liblouis.20.dylib", "liblouis.dylib", "/opt/homebrew/lib/liblouis.dylib"),
    "win32": ("liblouis.dll",),
}
"""By `sys.platform`; looked up by name, for `find_library` would start a compiler."""
_PROBE = "abc"
_PROBED: Cells = (1, 3, 9)
_DOTS, _UNICODE, _KNOWN_ALONE = 4, 64, 128
"""Its modes `dotsIO`, `ucBrl` and `noUndefined`: cells are wanted; of a character that is in no table, nothing."""
_SILENT = 60_000
"""Its log level `LOU_LOG_OFF`."""

_turn = Lock()
"""Liblouis keeps its tables and buffers in variables of its own, for one caller at a time."""


class Louis(NamedTuple):
    """A library that was found and tried."""

    library: Any
    version: str
    character: Any
    """The type of its characters: of 2 bytes or of 4."""

    def translate(self, text: str, language: str) -> Cells:
        """Raises: BrailleError for a character that its table does not have, OSError where the table fails."""
        for place, each in enumerate(text, 1):
            if not each.isascii():
                self._check_known(each, place, text, language)
        return self._call(text, TABLES[language], _DOTS | _UNICODE)

    def _check_known(self, character: str, place: int, text: str, language: str) -> None:
        if not any(self._call(character, TABLES[language], _DOTS | _UNICODE | _KNOWN_ALONE)):
            raise BrailleError(not_written(character, place, text, f"liblouis's table {TABLES[language]}"))

    def _call(self, text: str, table: str, mode: int) -> Cells:
        units = [unit for each in text for unit in _units(each, ctypes.sizeof(self.character))]
        source = (self.character * (len(units) + 1))(*units)
        target = (self.character * (16 * len(units) + 64))()
        read, written = ctypes.c_int(len(units)), ctypes.c_int(len(target))
        with _turn:
            done = self.library.lou_translateString(
                table.encode(), source, ctypes.byref(read), target, ctypes.byref(written), None, None, mode
            )
        if not done or read.value != len(units):
            raise OSError(f"liblouis {self.version} cannot use its table {table}")
        return tuple(each & 0x3F for each in target[: written.value])


def not_written(character: str, place: int, text: str, table: str) -> str:
    """What to say of a character that no table has."""
    return (
        f"{quoted(text)}: character {place}, {quoted(character)} (U+{ord(character):04X}), is not in {table}; "
        "spell it with other letters"
    )


def _units(character: str, size: int) -> list[int]:
    if size == 4 or ord(character) < 0x10000:
        return [ord(character)]
    pair = character.encode("utf-16-le")
    return [int.from_bytes(pair[:2], "little"), int.from_bytes(pair[2:], "little")]


@cache
def louis() -> Louis | str:
    """The library, or why it is not used: it is not installed, or does not write what it must."""
    for name in NAMES.get(sys.platform, NAMES["linux"]):
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        try:
            return _tried(library)
        except (OSError, AttributeError, ValueError, ctypes.ArgumentError) as error:
            return f"the liblouis that is installed cannot be used ({error})"
    return "liblouis is not installed"


def _tried(library: Any) -> Louis:
    """It writes three letters in each language as each of them does. Raises: OSError, AttributeError."""
    library.lou_version.restype = ctypes.c_char_p
    library.lou_setLogLevel(_SILENT)
    version = library.lou_version().decode()
    size = library.lou_charSize()
    if size not in (2, 4):
        raise OSError(f"its characters have {size} bytes")
    found = Louis(library, version, ctypes.c_uint16 if size == 2 else ctypes.c_uint32)
    for language in TABLES:
        if (wrote := found.translate(_PROBE, language)) != _PROBED:
            raise OSError(f"it writes {_PROBE} as {wrote} by {TABLES[language]}")
    return found
