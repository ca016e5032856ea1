"""The progress line of a terminal: the product that is being made, or the time of the session; off with `--quiet`."""

from __future__ import annotations

import logging
import sys
from typing import TYPE_CHECKING, Any

from ...errors import shown
from ..hooks import hookimpl

if TYPE_CHECKING:
    from ...data import Outcome, ServoReport

EXPORT = "export: "  # the product in the outcome of an exporter, before the exporter's name
# The logger of the time that compiling still takes; its own module would import numba.
COMPILING = "tangible_core.compiled.compiling.progress"
BAR_CELLS = 20
_shown: list[Any] = []  # the one spinner on the screen, if any


class _CompilingBar(logging.Handler):
    """A bar in place of the spinner's text while kernels are compiled."""

    def emit(self, record: logging.LogRecord) -> None:
        """Draw the share of the work that is done, and the time that is left."""
        if _shown:
            done = round(BAR_CELLS * getattr(record, "share", 0.0))
            bar = "#" * done + "." * (BAR_CELLS - done)
            _show(f"preparing for this computer, once: {bar} {record.getMessage()}")


logging.getLogger(COMPILING).addHandler(_CompilingBar())


@hookimpl
def tangible_stage_started(product: str, method: str) -> None:
    """Show a spinner with the name of the product or exporter."""
    _show(f"writing {method}" if product.startswith(EXPORT) else f"computing {product} with {method}")


@hookimpl
def tangible_stage_finished(outcome: Outcome) -> None:
    """Remove the spinner."""
    _clear()


@hookimpl
def tangible_servo_report(report: ServoReport) -> None:
    """Show time, force, part and material under the tip in one line, until the loop stops."""
    if report.stopped:
        _clear()
    else:
        under = ", ".join(shown(name) for name in (report.part, report.material) if name)
        on = f", on {under}" if under else ""
        _show(f"feeling: {report.time_s:5.1f} s, peak {report.peak_force_n:.2f} N{on}")


def _show(text: str) -> None:
    if not sys.stderr.isatty():
        return
    from rich.console import Console
    from rich.text import Text

    if _shown:
        _shown[0].update(Text(text))  # the name of a part may have brackets
    else:
        _shown.append(Console(stderr=True).status(Text(text), spinner="line"))  # not in cells of braille
        _shown[0].start()


def _clear() -> None:
    while _shown:
        _shown.pop().stop()
