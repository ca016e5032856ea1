"""Messages to systemd, for a program that it started as a service with `Type=notify`."""

import os
from contextlib import suppress


def tell_service_manager(state: str) -> None:
    """Send lines such as `READY=1` and `STATUS=...`; does nothing where no service manager listens.

    Source: sd_notify(3): a datagram to the socket that NOTIFY_SOCKET names, where @ stands for the abstract name space.
    """
    address = os.environ.get("NOTIFY_SOCKET", "")
    if address.startswith(("/", "@")):
        import socket  # most programs never need it

        with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            sender.sendto(state.encode(), address.replace("@", "\0", 1) if address[0] == "@" else address)
