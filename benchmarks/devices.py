"""Devices: every promise about them with its bound."""

from . import devices_falcon, devices_falcon_usb
from .figures import judged


def section() -> str:
    """Return the section as Markdown."""
    return "\n".join(
        [
            "No hardware was at hand: what is said of the Falcon was measured of its kernels, over a backend of USB "
            "that does nothing, and against the simulated device. Times are in processor time.",
            "",
            *judged([*devices_falcon.figures(), *devices_falcon_usb.figures()]),
        ]
    )
