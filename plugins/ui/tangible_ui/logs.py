"""Python's logging and warnings, forwarded to pages: who looks at the page sees a plugin's warnings there."""

import logging
import time
from collections.abc import Callable
from typing import final

# Packages whose information pages get too; from others, warnings and errors.
OWN = (
    "tangible_core",
    "tangible_depth",
    "tangible_texture",
    "tangible_render",
    "tangible_devices",
    "tangible_ui",
    "tangible_web",
)
# The logger of stages, left out because pages get events of stages.
KNOWN = "tangible_core.plugins.observers.log"
# The logger of the time that compiling still takes, which passes nothing to its parents.
COMPILING = "tangible_core.compiled.compiling.progress"
MAX_A_SECOND = 50


# A function that sends a line to all pages without waiting: `level` (detail, warning, error), `logger` and `text`.
Tell = Callable[..., None]


@final
class PageHandler(logging.Handler):
    """A handler that forwards records, at most MAX_A_SECOND, and never raises."""

    def __init__(self, tell: Tell) -> None:
        super().__init__(logging.INFO)
        self._tell = tell
        self._second, self._count = 0, 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Pass warnings of every logger, and information of our own packages."""
        own = record.name.partition(".")[0] in OWN and record.name != KNOWN
        return (own or record.levelno >= logging.WARNING) and super().filter(record) is not False

    def emit(self, record: logging.LogRecord) -> None:
        """Forward a record at once; count those of a flood, and report the count when it is over."""
        try:
            if (second := int(time.monotonic())) != self._second:
                left_out, self._second, self._count = self._count - MAX_A_SECOND, second, 0
                if left_out > 0:
                    text = f"{left_out} more lines came in one second and are left out"
                    self._tell(level="warning", logger=__name__, text=text)
            self._count += 1
            if self._count <= MAX_A_SECOND:
                self._tell(level=_level(record.levelno), logger=record.name, text=_text(record))
        except Exception:  # noqa: BLE001 - what is logged must never stop what logs
            self.handleError(record)


def tell_pages(tell: Tell, *, information: bool = False) -> PageHandler:
    """Forward logging and warnings to pages, too. information: also where no log was requested."""
    root, handler = logging.getLogger(), PageHandler(tell)
    if information:
        for name in OWN:
            logging.getLogger(name).setLevel(logging.INFO)
    if not root.handlers and logging.lastResort is not None:
        root.addHandler(logging.lastResort)
    for logger in (root, logging.getLogger(COMPILING)):
        logger.addHandler(handler)
    logging.captureWarnings(True)
    return handler


def silence(handler: PageHandler) -> None:
    """Stop forwarding to pages."""
    for logger in (logging.getLogger(), logging.getLogger(COMPILING)):
        logger.removeHandler(handler)
    logging.captureWarnings(False)


def _level(number: int) -> str:
    return "error" if number >= logging.ERROR else "warning" if number >= logging.WARNING else "detail"


def _text(record: logging.LogRecord) -> str:
    """Return the message, with an exception's sentence; its traceback is on standard error."""
    text = record.getMessage().strip()
    error = record.exc_info[1] if record.exc_info else None
    return text if error is None else f"{text}: {type(error).__name__}: {error}"
