"""The document that all tabs edit: the text of a pipeline file, with its history and its draft."""

import asyncio
import json
import logging
import os
from collections import deque
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, final

from tangible_core.errors import OutputError
from tangible_core.files import write_text

from ..stale_files import left_in
from ..user_data import user_folder

log: logging.Logger = logging.getLogger(__name__)
MAX_STEPS = 100
MAX_LEFT = 10  # number of drafts that are kept; older ones are removed


class Text(NamedTuple):
    """The text of a pipeline file, and its path."""

    text: str
    path: Path


@final
class Texts:
    """Texts to undo and to redo."""

    def __init__(self) -> None:
        self.lock: asyncio.Lock = asyncio.Lock()
        """Lock for reading the document, computing another text of it, and replacing it."""
        self._before: deque[Text] = deque(maxlen=MAX_STEPS)
        self._after: list[Text] = []

    @property
    def all(self) -> list[str]:
        """All texts of the history."""
        return [text.text for text in (*self._before, *self._after)]

    def rewrite(self, others: Mapping[str, str]) -> None:
        """Replace texts by equivalent ones, after a file that they name was moved."""
        before = [text._replace(text=others.get(text.text, text.text)) for text in self._before]
        self._before = deque(before, maxlen=MAX_STEPS)
        self._after = [text._replace(text=others.get(text.text, text.text)) for text in self._after]

    def leave(self, now: Text) -> None:
        """Add the text that is replaced to the history; what was undone is lost."""
        if now.text:
            self._before.append(now)
        self._after.clear()

    def next(self, *, back: bool) -> Text | None:
        """Return the text of one step back, or the one that was undone last; None at the end."""
        texts = self._before if back else self._after
        return texts[-1] if texts else None

    def step(self, now: Text, *, back: bool) -> None:
        """Move this text to the other side of the history, after a step to `next`."""
        gone, back_again = (self._before, self._after) if back else (self._after, self._before)
        back_again.append(now)
        gone.pop()


class Draft(NamedTuple):
    """The unsaved document of a program that ended."""

    file: Path
    text: Text
    at_s: float  # time of the last edit, Unix time


@final
class Drafts:
    """The draft of this program: a file that exists while the document differs from the saved one."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._file = folder / f"{os.getpid()}.json"
        self._file_text = ""
        self._newest = self._on_disk = Text("", Path())
        self._lock = asyncio.Lock()
        self._has_failed = False
        self.earlier: Draft | None = None
        """The draft of an earlier program."""

    def remember_opened(self, text: str) -> None:
        """Remember the text that a file holds: it needs no draft."""
        self._file_text = text

    @property
    def opened_text(self) -> str:
        """The text of the document's file when it was opened or saved."""
        return self._file_text

    async def keep(self, text: Text) -> None:
        """Write the document's text as a draft. A full disk is warned of once."""
        self._newest = text
        async with self._lock:  # one write at a time; of many edits the newest alone
            if (text := self._newest) != self._on_disk:
                await asyncio.to_thread(self._put, text)
                self._on_disk = text

    def look(self) -> Draft | None:
        """Return the newest draft of an earlier program, and remove old ones."""
        drafts = sorted(filter(None, map(_read, left_in(self._folder, "*.json"))), key=lambda draft: draft.at_s)
        for draft in drafts[:-MAX_LEFT]:
            _remove(draft.file)
        self.earlier = drafts[-1] if drafts else None
        return self.earlier

    def drop(self) -> None:
        """Remove the earlier program's draft: it was restored, or is not wanted."""
        if self.earlier is not None:
            _remove(self.earlier.file)
            self.earlier = None

    def _put(self, text: Text) -> None:
        if text.text == self._file_text:
            _remove(self._file)
            return
        try:
            write_text(self._file, json.dumps({"text": text.text, "path": str(text.path)}), private=True)
            self._has_failed = False
        except OutputError as error:
            if not self._has_failed:
                log.warning("unsaved edits are not kept for the next start: %s", error)
            self._has_failed = True


def _read(file: Path) -> Draft | None:
    try:
        draft: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return Draft(file, Text(str(draft["text"]), Path(str(draft["path"]))), file.stat().st_mtime)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _remove(file: Path) -> None:
    with suppress(OSError):
        file.unlink()


@final
class Document:
    """The text of a pipeline file, and its path."""

    def __init__(self, sets: Iterable[str]) -> None:
        self.text: str = ""
        self.path: Path = Path.cwd() / "untitled.yaml"
        self.digest: str = ""
        self.sets: list[str] = list(sets)
        """Changes from the command line, which override the file."""
        self.texts: Texts = Texts()
        self.drafts: Drafts = Drafts(user_folder("unsaved"))

    @property
    def now(self) -> Text:
        """The text and its path."""
        return Text(self.text, self.path)

    def arguments(self, sets: list[str] | None = None) -> dict[str, Any]:
        """Return the document as jobs take it. sets: changes to it; by default those of the command line."""
        return {"text": self.text, "path": self.path, "sets": self.sets if sets is None else sets}
