"""A device over a pipeline's surface, and how its hand followed its path there."""

import numpy as np

from ...mapping import mapped, over, wanted
from ...plugins.interfaces import HapticDevice
from ...session import EVERY, Recording, TrackingError, tracking_error
from ..engine.engine import Engine


def felt_device(engine: Engine, device: HapticDevice | None = None) -> HapticDevice | None:
    """This or the configured device as the picture sees it, a path of its own over the surface; None where none is."""
    felt = engine.config.felt_device if device is None else mapped(device, engine.config.mapping)
    return felt and over(felt, engine.make("surface").extent_m)


def how_followed(engine: Engine, felt: HapticDevice | None, seen: Recording) -> TrackingError:
    """How the hand followed the path of a device of `felt_device`. seen: one of `EVERY` ticks."""
    path_m = felt and wanted(felt, np.arange(len(seen.rows)) * EVERY)
    return tracking_error(seen, path_m, engine.make("surface"))
