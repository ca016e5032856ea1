"""`feel`: a pipeline's surface on its device."""

import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from .. import session
from ..errors import ConfigError
from . import show
from .run import about, felt, open_pipeline


def feel(config: Path, sets: Sequence[str], seconds: float, record: Path | None, as_json: bool, cached: bool) -> None:
    """Make the touch, open the device, feel, and say how it went."""
    pipeline = open_pipeline(config, sets, cached)
    chosen, device = pipeline.config.device, pipeline.config.felt_device
    if chosen is None or device is None:
        raise ConfigError(f"{config}: `device:` is missing; add one, such as `device: {{use: mock}}`")
    if record is not None:
        session.check_record_path(record)
    touch = pipeline.make("touch")
    if record is not None and record.suffix == ".nc":  # the one that grows while it is felt
        with session.Writer(record, about(pipeline)) as writer:
            recording = felt(pipeline, touch, device, seconds, writer)
    else:
        recording = felt(pipeline, touch, device, seconds)
        if record is not None:
            replace(recording, about=about(pipeline).stamped()).save(record)
    figures: dict[str, Any] = {"device": chosen.name, "spec": asdict(device.spec()), **recording.figures()}
    if as_json:
        show.print_json(
            {"outcomes": show.as_rows(pipeline.outcomes), "figures": figures, "file": record and str(record)}
        )
    else:
        show.outcomes(pipeline.outcomes)
        show.say("")
        show.table(("figure", "value"), [(name, _text(value)) for name, value in recording.figures().items()])
    if recording.stopped == session.INTERRUPTED:
        raise KeyboardInterrupt
    if recording.stopped:
        sys.stdout.flush()
        raise session.failure(recording)


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
