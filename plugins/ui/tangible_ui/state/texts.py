"""The document's history: undo and redo."""

from asyncio import Lock
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, final

MAX_STEPS = 100


class Text(NamedTuple):
    """The text of a pipeline file, and its path."""

    text: str
    path: Path


@final
class Texts:
    """Texts to undo and to redo."""

    def __init__(self) -> None:
        self.lock: Lock = Lock()
        """Lock for reading the document, computing another text of it, and replacing it."""
        self._before: deque[Text] = deque(maxlen=MAX_STEPS)
        self._after: list[Text] = []

    @property
    def can_undo(self) -> bool:
        """True if there is a text to undo to."""
        return bool(self._before)

    @property
    def can_redo(self) -> bool:
        """True if there is a text to redo."""
        return bool(self._after)

    @property
    def all(self) -> list[str]:
        """All texts of the history."""
        return [each.text for each in (*self._before, *self._after)]

    def rewrite(self, others: Mapping[str, str]) -> None:
        """Replace texts by equivalent ones, after a file that they name was moved."""
        before = [each._replace(text=others.get(each.text, each.text)) for each in self._before]
        self._before = deque(before, maxlen=MAX_STEPS)
        self._after = [each._replace(text=others.get(each.text, each.text)) for each in self._after]

    def leave(self, now: Text) -> None:
        """Add the text that is replaced to the history; what was undone is lost."""
        if now.text:
            self._before.append(now)
        self._after.clear()

    def before(self) -> Text | None:
        """Return the text of one step back."""
        return self._before[-1] if self._before else None

    def after(self) -> Text | None:
        """Return the text that was undone last."""
        return self._after[-1] if self._after else None

    def step(self, now: Text, *, back: bool) -> None:
        """Move this text to the other side of the history, after a step to `before` or `after`."""
        if back:
            self._after.append(now)
            self._before.pop()
        else:
            self._before.append(now)
            self._after.pop()
