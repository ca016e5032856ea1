"""Errors of USB as messages that name the cure."""

from tangible_core.errors import DeviceError

UDEV_FILE = "/etc/udev/rules.d/70-novint-falcon.rules"
UDEV_RULE = (
    'SUBSYSTEM=="usb", ATTR{idVendor}=="0403", ATTR{idProduct}=="cb48", MODE="0660", GROUP="plugdev", TAG+="uaccess"'
)
"""Rule for Linux: the user at the machine and the group plugdev may use a Falcon."""

REPLUG = "check its plug and its power supply, then open it again"
NO_PERMISSION = (
    f"there is no permission to use it; write this line to {UDEV_FILE}:\n  {UDEV_RULE}\n"
    "then run `sudo udevadm control --reload-rules && sudo udevadm trigger`, and plug it in again"
)
NO_DRIVER = "the system's driver for it cannot be used; on Windows give it the WinUSB driver with Zadig (zadig.akeo.ie)"
NO_LIBUSB = (
    "libusb is missing; install it (Debian, Ubuntu: `apt install libusb-1.0-0`; Fedora: `dnf install libusb1`; "
    "macOS: `brew install libusb`; Windows: `pip install libusb-package`)"
)
CAUSES = {
    2: f"it was unplugged; {REPLUG}",
    5: f"the transfer failed; {REPLUG}",
    13: NO_PERMISSION,
    16: "another program is using it; close that one, or give the serial or the index of another Falcon",
    19: f"it was unplugged; {REPLUG}",
    32: f"it refused the request (stall); {REPLUG}",
    **dict.fromkeys((75, 84, 132), f"it sent more than was requested (overflow); {REPLUG}"),
    **dict.fromkeys((60, 110, 138, 10060), f"it does not answer (time-out); {REPLUG}"),
}
"""Causes by the number of the system's error; two errors have other numbers on macOS and on Windows."""


def device_error(error: Exception, place: str, doing: str) -> DeviceError:
    """Return the DeviceError for an error of pyusb: the place, the activity, the cause and the cure."""
    if isinstance(error, NotImplementedError):
        return error_of_cause(place, doing, NO_DRIVER)
    number = error.errno if isinstance(error, OSError) else None
    cause = CAUSES.get(number or 0, f"{error}; {REPLUG}")
    return error_of_cause(place, doing, cause)


def error_of_cause(place: str, doing: str, cause: str) -> DeviceError:
    """Return the DeviceError for a cause; its lines are kept, as one of them is to be copied."""
    return DeviceError(*f"{place}, {doing}: {cause}".splitlines())
