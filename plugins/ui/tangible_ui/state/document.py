"""The document that all tabs edit: the text of a pipeline file, with its history and its draft."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, final

from ..user_data import user_folder
from .drafts import Drafts
from .texts import Text, Texts


@final
class Document:
    """The text of a pipeline file, and its path."""

    def __init__(self, sets: Iterable[str]) -> None:
        self.text: str = ""
        self.path: Path = Path.cwd() / "untitled.yaml"
        self.digest: str = ""
        """Digest of the text, as events name it."""
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
