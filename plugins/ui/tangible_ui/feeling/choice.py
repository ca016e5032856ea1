"""Which device is felt, and whether somebody agreed to that."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from tangible_core.errors import ConfigError
from tangible_core.plugins.interfaces import HapticDevice

NOT_FOR_A_PAGE = ("mapping.clutch_button=null", "mapping.limits_m=null")
"""A page's hand is where the mouse is: no clutch moves it, and no box of another device's bounds it."""


@dataclass
class Choice:
    """What a person chose to feel with."""

    kind: Literal["hand", "document", "other"] = "hand"
    """The page's own hand; the device of the document; another one."""
    name: str = ""
    """Of another one."""
    sure: bool = False
    """Whether the person was told that it has a motor, and said yes."""
    agreed: type[HapticDevice] | None = None
    """The device that was said yes to; that of a document may become another one."""

    def sets(self, own_device: Mapping[str, Any]) -> list[str]:
        """Changes to the document."""
        if self.kind == "hand":
            return [f"device={json.dumps(own_device)}", *NOT_FOR_A_PAGE]
        return [f"device={json.dumps({'use': self.name})}"] if self.kind == "other" else []

    def check(self, device: HapticDevice) -> None:
        """Whether this may be opened. Raises: NotConfirmed for a motor that nobody said yes to."""
        if device.spec().simulated:
            return
        if not self.sure or self.agreed not in (None, type(device)):
            raise NotConfirmed(
                f"the device {type(device).__name__} has a motor, and is opened only by who chooses it in the panel "
                "Devices; what was felt before goes on"
            )
        self.agreed = type(device)


class NotConfirmed(ConfigError):
    """A device with a motor was to be opened, and nobody had said yes."""
