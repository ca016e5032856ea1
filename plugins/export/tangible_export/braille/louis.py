"""Liblouis, where it is installed, by ctypes; the package `louis` on PyPI is something else."""

import ctypes
from functools import cache
from threading import Lock
from typing import Any, NamedTuple

from tangible_core.errors import BrailleError, quoted
from tangible_core.runtime.system import library_names

from .cells import Cells

# Unified English Braille, German Basisschrift, French Braille uniformisé.
TABLES = {"en": "en-ueb-g1.ctb", "de": "de-g0.utb", "fr": "fr-bfu-comp6.utb"}
# Unified English Braille, German Kurzschrift, French Braille abrégé.
CONTRACTED = {"en": "en-ueb-g2.ctb", "de": "de-g2.ctb", "fr": "fr-bfu-g2.ctb"}
VERSION = 20
_PROBE = "abc"
_PROBED: Cells = (1, 3, 9)
# Modes `dotsIO`, `ucBrl` and `noUndefined` of liblouis: return cells, and nothing for a character not in the table.
_DOTS, _UNICODE, _KNOWN_ALONE = 4, 64, 128
_SILENT = 60_000

# Lock around each call: liblouis keeps its tables and buffers in global variables.
_turn = Lock()


class Louis(NamedTuple):
    """A library that was loaded and tested."""

    library: Any
    version: str
    character: Any

    def translate(self, text: str, language: str, grade: int = 1) -> Cells:
        """Translate text. Raises: BrailleError for a character not in the table, OSError if the table fails."""
        table = (TABLES if grade == 1 else CONTRACTED)[language]
        for place, character in enumerate(text, 1):
            if not character.isascii():
                self._check_known(character, place, text, table)
        return self._call(text, table, _DOTS | _UNICODE)

    def _check_known(self, character: str, place: int, text: str, table: str) -> None:
        if not any(self._call(character, table, _DOTS | _UNICODE | _KNOWN_ALONE)):
            raise BrailleError(missing_character(character, place, text, f"liblouis's table {table}"))

    def _call(self, text: str, table: str, mode: int) -> Cells:
        size = ctypes.sizeof(self.character)
        units = memoryview(text.encode(f"utf-{8 * size}", "surrogatepass")).cast("H" if size == 2 else "I")[1:]
        source = (self.character * (len(units) + 1))(*units)
        target = (self.character * (16 * len(units) + 64))()
        read, length = ctypes.c_int(len(units)), ctypes.c_int(len(target))
        with _turn:
            success = self.library.lou_translateString(
                table.encode(), source, ctypes.byref(read), target, ctypes.byref(length), None, None, mode
            )
        if not success or read.value != len(units):
            raise OSError(f"liblouis {self.version} cannot use its table {table}")
        return tuple(cell & 0x3F for cell in target[: length.value])


def missing_character(character: str, place: int, text: str, table: str) -> str:
    """Return the message for a character that is not in a table."""
    return (
        f"{quoted(text)}: character {place}, {quoted(character)} (U+{ord(character):04X}), is not in {table}; "
        "spell it with other letters"
    )


@cache
def louis() -> Louis | str:
    """Return the library, or the reason why it is not used."""
    for name in library_names("louis", VERSION):
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        try:
            return _test(library)
        except (OSError, AttributeError, ValueError, ctypes.ArgumentError) as error:
            return f"the liblouis that is installed cannot be used ({error})"
    return "liblouis is not installed"


def _test(library: Any) -> Louis:
    """Let the library write three letters in each language. Raises: OSError, AttributeError if it does not do so."""
    library.lou_version.restype = ctypes.c_char_p
    library.lou_setLogLevel(_SILENT)
    version = library.lou_version().decode()
    size = library.lou_charSize()
    if size not in (2, 4):
        raise OSError(f"its characters have {size} bytes")
    liblouis = Louis(library, version, ctypes.c_uint16 if size == 2 else ctypes.c_uint32)
    for language in TABLES:
        if (cells := liblouis.translate(_PROBE, language)) != _PROBED:
            raise OSError(f"it writes {_PROBE} as {cells} by {TABLES[language]}")
    return liblouis
