"""What Python's logging and warnings say, told to pages: a plugin's warning is for who looks at the page."""

import logging
import time
from typing import Protocol, final

OWN = ("tangible_core", "tangible_depth", "tangible_texture", "tangible_render", "tangible_devices", "tangible_ui")
"""Packages of which pages hear what is logged as information, too; of others, warnings and errors."""
KNOWN = "tangible_core.plugins.observers.log"
"""It says of the stages what pages are told anyway."""
MOST_A_SECOND = 50


class Tell(Protocol):
    """Says a line of the log to all pages; in any thread. level: detail, warning or error."""

    def __call__(self, *, level: str, logger: str, text: str) -> None:
        """Does not wait."""


@final
class PageHandler(logging.Handler):
    """Hands on what is logged, never more than pages can show; and never raises."""

    def __init__(self, tell: Tell) -> None:
        super().__init__(logging.INFO)
        self._tell = tell
        self._second, self._count = 0, 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Warnings of everybody; information of our own packages."""
        own = record.name.partition(".")[0] in OWN and record.name != KNOWN
        return (own or record.levelno >= logging.WARNING) and super().filter(record) is not False

    def emit(self, record: logging.LogRecord) -> None:
        """Told at once; what floods is counted, and the count told when it is over."""
        try:
            if (second := int(time.monotonic())) != self._second:
                left_out, self._second, self._count = self._count - MOST_A_SECOND, second, 0
                if left_out > 0:
                    text = f"{left_out} more lines came in one second and are left out"
                    self._tell(level="warning", logger=__name__, text=text)
            self._count += 1
            if self._count <= MOST_A_SECOND:
                self._tell(level=_level(record.levelno), logger=record.name, text=_text(record))
        except Exception:  # noqa: BLE001 - what is logged must never stop what logs
            self.handleError(record)


def tell_pages(tell: Tell, *, information: bool = False) -> PageHandler:
    """From now on what this process logs and warns of is told; standard error hears it as before.

    information: also where nobody asked for a log, as in a process whose standard error is nobody's.
    """
    root, handler = logging.getLogger(), PageHandler(tell)
    if information:
        for name in OWN:
            logging.getLogger(name).setLevel(logging.INFO)
    if not root.handlers and logging.lastResort is not None:
        root.addHandler(logging.lastResort)
    root.addHandler(handler)
    logging.captureWarnings(True)
    return handler


def silence(handler: PageHandler) -> None:
    """Pages are told nothing more."""
    logging.getLogger().removeHandler(handler)
    logging.captureWarnings(False)


def _level(number: int) -> str:
    return "error" if number >= logging.ERROR else "warning" if number >= logging.WARNING else "detail"


def _text(record: logging.LogRecord) -> str:
    """The message; of an exception the sentence, for the traceback is in standard error."""
    text = record.getMessage().strip()
    error = record.exc_info[1] if record.exc_info else None
    return text if error is None else f"{text}: {type(error).__name__}: {error}"
