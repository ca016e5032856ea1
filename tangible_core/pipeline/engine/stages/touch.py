"""The touch: a force law on the surface, whose materials are limited to what the device renders stably."""

import logging
from functools import cached_property

from ....data import HapticSurface
from ....errors import ConfigError
from ....plugins.interfaces import HapticDevice, Touch
from ....plugins.notes import note
from ....preflight import fit_surface
from ...config.model import PipelineConfig
from ..stage import Inputs, MethodStage

log: logging.Logger = logging.getLogger(__name__)


class TouchStage(MethodStage):
    """Give the force law the surface."""

    product = "touch"
    kind = "render"
    cached = False

    @property
    def needs(self) -> tuple[str, ...]:
        return ("surface",)

    @cached_property
    def key(self) -> str:
        return self.identity[1]

    def make(self, inputs: Inputs) -> Touch:
        method, device = self.required_choice, self.config.felt_device
        surface, limits = inputs["surface"], ""
        if device is not None:
            surface, limits = fit_to_device(surface, self.config, device)
        if limits:
            note(log, limits)
        return method.method.touch(surface)

    @cached_property
    def skip(self) -> None:
        return None

    @cached_property
    def refusal(self) -> ConfigError | None:
        return self.config.missing("render") if self.config.render is None else None


def fit_to_device(surface: HapticSurface, config: PipelineConfig, device: HapticDevice) -> tuple[HapticSurface, str]:
    """Limit the materials to the device, and return the surface with a sentence about the limits, if any."""
    if config.materials.fit == "never":
        return surface, ""
    return fit_surface(surface, device.spec(), config.safety)
