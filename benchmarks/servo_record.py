"""Whether a long recording has every tick; what it does to the loop, `servo_late` compares."""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tangible_core.data import ServoReport
from tangible_core.servo import Safety
from tangible_core.session import Recording, Writer, live

from .figures import Figure
from .servo_loops import touch
from .tests_path import Circling

MINUTES = float(os.environ.get("TANGIBLE_MINUTES", "10"))


def figures() -> Iterator[Figure]:
    """Yield a long recording."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.nc"
        with Writer(path) as writer:
            report = live.run_in_real_time(touch(), Circling(), 60 * MINUTES, Safety(), _ignore, writer.append)
        kept, size = len(Recording.load(path).rows), path.stat().st_size
    said = f"{report.ticks} ticks, {report.ticks - kept} not recorded; {size / report.ticks:.0f} bytes a tick"
    yield Figure(f"recorder, {MINUTES:g} minutes", "no tick lost", said, report.ticks == kept)


def _ignore(report: ServoReport) -> None:
    pass
