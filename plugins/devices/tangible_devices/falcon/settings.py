"""What of a Falcon's options it is opened and driven by."""

from dataclasses import dataclass

from tangible_core.mapping.device_calibrations import load_calibration

from .calibration import Calibration


@dataclass(frozen=True)
class Settings:
    """Each is the option of `Falcon` of that name."""

    serial: str | None
    index: int
    calibration: Calibration | None
    home_within_s: float
    leds: bool
    velocity_samples: int
    in_flight: int
    event_character: bool

    def calibrated(self, serial: str) -> Calibration:
        """The option, or what was kept for this serial number, or the defaults. Raises: DeviceError if damaged."""
        return self.calibration or load_calibration("falcon", serial, Calibration) or Calibration()
