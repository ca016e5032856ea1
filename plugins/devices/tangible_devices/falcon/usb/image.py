"""A Falcon's firmware as a file: the stream for the boot loader of its TI C28x processor.

Little-endian 16-bit words: the key 0x08AA, 8 reserved words of 0, the entry point (high word, low word), then blocks
of {length in words, destination high, destination low, data}, ended by a length of 0.
Source: TI SPRUHE8 and SPRUI07, boot ROM, SCI boot data stream.
"""

import struct
from pathlib import Path

from tangible_core.errors import DeviceError
from tangible_core.files import check_file

KEY = 0x08AA
RESERVED_WORDS = 8
MAX_BYTES = 1 << 18
"""Largest file that is read: more than the processor's memory."""
WHENCE = (
    "it comes with Novint's driver and in the folder `firmware` of libnifalcon (nvent_firmware.bin), "
    "under Novint's licence, so that it cannot be shipped here"
)


def read_image(path: Path) -> bytes:
    """Read the whole file. Raises: DeviceError if it cannot be read, or is not a complete stream."""
    try:
        check_file(path.expanduser())
        with path.expanduser().open("rb") as file:
            image = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise DeviceError(f"{path}: cannot be read: {error.strerror}; give the option firmware; {WHENCE}") from error
    if fault := find_fault(image):
        raise DeviceError(f"{path}: is not a Falcon firmware: {fault}; {WHENCE}")
    return image


def find_fault(image: bytes) -> str:
    """Return the fault of an image; empty if it has none."""
    if not image or len(image) % 2 or len(image) > MAX_BYTES:
        return f"it has {len(image)} bytes; an even number up to {MAX_BYTES} is needed"
    words = struct.unpack(f"<{len(image) // 2}H", image)
    if words[0] != KEY:
        return f"it begins with 0x{words[0]:04X} and not with 0x{KEY:04X}"
    if any(words[1 : 1 + RESERVED_WORDS]):
        return "its reserved words are not 0"
    at = first = 1 + RESERVED_WORDS + 2
    while at < len(words) and words[at]:
        at += 3 + words[at]
    if at >= len(words):
        return "it ends in the middle of a block; it was cut off"
    if at == first:
        return "it holds no block"
    return f"{len(image) - 2 * (at + 1)} bytes follow its end" if at + 1 < len(words) else ""
