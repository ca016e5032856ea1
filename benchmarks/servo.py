"""The force loop: what a tick costs, how late it is, how soon the first one comes, and a long recording.

TANGIBLE_MINUTES: how long the recorder is tried, 10 unless it is set.
"""

from . import servo_loops, servo_record, servo_ticks
from .figures import judged, part


def section() -> str:
    """Return the section as Markdown."""
    figures = [
        *part("ticks", lambda: list(servo_ticks.figures())),
        *part("beside C", lambda: list(servo_loops.beside_c())),
        *part("beside a web server", lambda: list(servo_loops.beside_a_server())),
        *part("recorder", lambda: list(servo_record.figures())),
    ]
    head = "A millisecond a tick; lateness is from when a tick was due to when it began, in slices in turn."
    return "\n".join([head, "", *judged(figures)])
