"""The chosen device, and the person's consent to its motor."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from tangible_core.errors import ConfigError
from tangible_core.files.yaml import json_in_yaml
from tangible_core.plugins import HapticDevice

# Changes to the document for the page's hand, which is where the mouse is: no clutch, and no other device's limits.
NOT_FOR_A_PAGE = ("mapping.clutch_button=null", "mapping.limits_m=null")


@dataclass
class Choice:
    """The device that a person chose."""

    kind: Literal["hand", "document", "other"] = "hand"
    name: str = ""
    sure: bool = False  # true if the person was warned of the motor and agreed
    # The device that the person agreed to: a document may come to name another one.
    agreed_device: type[HapticDevice] | None = None

    def sets(self, own_device: Mapping[str, Any]) -> list[str]:
        """Return the changes to the document, as `--set` takes them."""
        if self.kind == "hand":
            return [f"device={json_in_yaml(own_device)}", *NOT_FOR_A_PAGE]
        return [f"device={json_in_yaml({'use': self.name})}"] if self.kind == "other" else []

    def check(self, device: HapticDevice) -> None:
        """Check that a device may be opened. Raises: NotConfirmed for a motor that nobody agreed to."""
        if device.spec().simulated:
            return
        if not self.sure or self.agreed_device not in (None, type(device)):
            raise NotConfirmed(
                f"the device {type(device).__name__} has a motor; choose it in the panel Devices to open it. The "
                "device before stays in use"
            )
        self.agreed_device = type(device)


class NotConfirmed(ConfigError):
    """A device with a motor was about to be opened without consent."""
