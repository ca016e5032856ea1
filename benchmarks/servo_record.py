"""Whether a recorder costs the loop a tick."""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tangible_core.data import ServoReport
from tangible_core.servo import Safety
from tangible_core.session import Recording, Writer, live
from tangible_core.testing.loop_devices import Circling

from .figures import Figure
from .servo_loops import touch

MINUTES = float(os.environ.get("TANGIBLE_MINUTES", "10"))


def figures() -> Iterator[Figure]:
    """A long recording, and the same loop without one."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.nc"
        with Writer(path) as writer:
            report = live.run_in_real_time(touch(), Circling(), 60 * MINUTES, Safety(), _ignore, writer.append)
        kept, size = len(Recording.load(path).rows), path.stat().st_size
    alone = live.run_in_real_time(touch(), Circling(), 60.0, Safety(), _ignore, lambda rows: None)
    assert report.late_us is not None and alone.late_us is not None
    said = (
        f"{report.ticks} ticks, {report.ticks - kept} not recorded, {report.overruns} periods without a tick; "
        f"p99.9 of lateness {report.late_us.p999:.0f} us, {alone.late_us.p999:.0f} us without a recorder; "
        f"{size / report.ticks:.0f} bytes a tick"
    )
    met = report.ticks == kept and report.overruns == 0
    yield Figure(f"recorder, {MINUTES:g} minutes", "no tick lost or late by a period", said, met)


def _ignore(report: ServoReport) -> None:
    pass
