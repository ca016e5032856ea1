"""Unsaved edits of the document, kept in a file of the user's and offered at the next start."""

import asyncio
import json
import logging
import os
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, final

from tangible_core.errors import OutputError
from tangible_core.files import write_text

from ..stale_files import left_in
from .texts import Text

log: logging.Logger = logging.getLogger(__name__)
MAX_LEFT = 10
"""Number of drafts that are kept; older ones are removed."""


class Draft(NamedTuple):
    """The unsaved document of a program that ended."""

    file: Path
    text: Text
    at_s: float
    """Time of the last edit, Unix time."""


@final
class Drafts:
    """The draft of this program: a file that exists while the document differs from the saved one."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._file = folder / f"{os.getpid()}.json"
        self._opened = ""
        self._newest = self._kept = Text("", Path())
        self._lock = asyncio.Lock()
        self._failed = False
        self.left: Draft | None = None
        """The draft of an earlier program."""

    def remember_opened(self, text: str) -> None:
        """Remember the text that a file holds: it needs no draft."""
        self._opened = text

    @property
    def opened_text(self) -> str:
        """The text of the document's file when it was opened or saved."""
        return self._opened

    async def keep(self, text: Text) -> None:
        """Write the document's text as a draft. A full disk is warned of once."""
        self._newest = text
        async with self._lock:  # one write at a time; of many edits the newest alone
            if (text := self._newest) != self._kept:
                await asyncio.to_thread(self._put, text)
                self._kept = text

    def look(self) -> Draft | None:
        """Return the newest draft of an earlier program, and remove old ones."""
        found = sorted(filter(None, map(_read, left_in(self._folder, "*.json"))), key=lambda draft: draft.at_s)
        for draft in found[:-MAX_LEFT]:
            _remove(draft.file)
        self.left = found[-1] if found else None
        return self.left

    def drop(self) -> None:
        """Remove the earlier program's draft: it was restored, or is not wanted."""
        if self.left is not None:
            _remove(self.left.file)
            self.left = None

    def _put(self, text: Text) -> None:
        if text.text == self._opened:
            _remove(self._file)
            return
        try:
            write_text(self._file, json.dumps({"text": text.text, "path": str(text.path)}), private=True)
            self._failed = False
        except OutputError as error:
            if not self._failed:
                log.warning("unsaved edits are not kept for the next start: %s", error)
            self._failed = True


def _read(file: Path) -> Draft | None:
    try:
        said: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return Draft(file, Text(str(said["text"]), Path(str(said["path"]))), file.stat().st_mtime)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _remove(file: Path) -> None:
    with suppress(OSError):
        file.unlink()
