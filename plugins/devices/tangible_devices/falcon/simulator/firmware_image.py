"""A firmware image that nobody ever ran: the structure of a real one, with numbers drawn by chance."""

import struct

import numpy as np

from ..usb.image import KEY, RESERVED_WORDS

BLOCKS = ((1821, 0x3F8002), (120, 0x3F8E3D), (168, 0x93A2), (2, 0x3F8000))
"""Length in words and destination; half as long as a real one."""


def synthetic_image(seed: int = 0) -> bytes:
    """The boot stream of an image with random content."""
    numbers = np.random.default_rng(seed)
    words = [KEY, *[0] * RESERVED_WORDS, 0x003F, 0x8002]
    for length, destination in BLOCKS:
        words += [length, destination >> 16, destination & 0xFFFF, *numbers.integers(0, 1 << 16, length).tolist()]
    return struct.pack(f"<{len(words) + 1}H", *words, 0)
