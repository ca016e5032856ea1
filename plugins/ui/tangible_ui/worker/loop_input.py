"""Input of the force loop: a packed touch, its device, mapping and limits."""

from threading import Event
from typing import Any

from tangible_core.data import HapticSurface
from tangible_core.mapping import over
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import PipelineConfig
from tangible_core.pipeline.engine import Progress
from tangible_core.plugins import Touch
from tangible_core.runtime import dumps
from tangible_core.servo import pack_touch
from tangible_core.session import materials_text


def loop_input_of(pipeline: Pipeline, report: Progress | None = None, stop: Event | None = None) -> dict[str, Any]:
    """Make the touch, and return the loop's input. Raises: ConfigError without a device; as `Pipeline.make`."""
    touch, config = pipeline.make("touch", report, stop), pipeline.config
    return parcel_of(touch, pipeline.make("surface"), config)


def parcel_of(touch: Touch, surface: HapticSurface, config: PipelineConfig) -> dict[str, Any]:
    """Pack a touch into the loop's input. Raises: ConfigError without a device; DeviceError if there is no room."""
    if config.device is None or config.felt_device is None:
        raise config.missing("device")
    device = over(config.felt_device, surface.extent_m)
    sent = pack_touch(touch, device.spec())
    return {
        "parcel": str(sent.parcel),
        "stiffness_n_per_m": sent.stiffness_n_per_m,
        "law": config.render.name if config.render else "",
        "device_name": config.device.name,
        "device": dumps(device),
        "mapping": dumps(config.mapping),
        "safety": dumps(config.safety),
        "materials": materials_text(surface),
    }
