"""The force loop: what a tick costs, and how late it is with real-time rights."""

from . import servo_loops, servo_ticks
from .figures import judged, part


def section() -> str:
    """Return the section as Markdown."""
    figures = [
        *part("ticks", lambda: list(servo_ticks.figures())),
        *part("beside C", lambda: list(servo_loops.beside_c())),
    ]
    head = "A millisecond a tick; lateness is from when a tick was due to when it began, in slices in turn."
    return "\n".join([head, "", *judged(figures)])
