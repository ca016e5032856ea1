"""The texts that the document had: one step back, one step forth."""

from asyncio import Lock
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, final

MOST_STEPS = 100


class Text(NamedTuple):
    """A pipeline file as text, and where it stands."""

    text: str
    path: Path


@final
class Texts:
    """What was before, and what was undone."""

    def __init__(self) -> None:
        self.lock = Lock()
        """Held by who reads the document, makes another text of it, and puts that in its place."""
        self._before: deque[Text] = deque(maxlen=MOST_STEPS)
        self._after: list[Text] = []

    @property
    def can_undo(self) -> bool:
        """Whether there is a text before."""
        return bool(self._before)

    @property
    def can_redo(self) -> bool:
        """Whether one was undone."""
        return bool(self._after)

    @property
    def all(self) -> list[str]:
        """Every text that can be stepped to."""
        return [each.text for each in (*self._before, *self._after)]

    def rewrite(self, others: Mapping[str, str]) -> None:
        """Texts that say the same in other words, as a file that they name is elsewhere now."""
        before = [each._replace(text=others.get(each.text, each.text)) for each in self._before]
        self._before = deque(before, maxlen=MOST_STEPS)
        self._after = [each._replace(text=others.get(each.text, each.text)) for each in self._after]

    def leave(self, now: Text) -> None:
        """Another text takes the place of this one, and what was undone is lost."""
        if now.text:
            self._before.append(now)
        self._after.clear()

    def before(self) -> Text | None:
        """The text of one step back."""
        return self._before[-1] if self._before else None

    def after(self) -> Text | None:
        """The text that was undone last."""
        return self._after[-1] if self._after else None

    def step(self, now: Text, *, back: bool) -> None:
        """This one gives way to `before` or `after`."""
        if back:
            self._after.append(now)
            self._before.pop()
        else:
            self._before.append(now)
            self._after.pop()
