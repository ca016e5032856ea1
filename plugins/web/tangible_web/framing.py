"""The binary frames of the websocket, little-endian; a test compares them with the page, kit/server/protocol.ts."""

import struct

from tangible_core.data import BEACON_SHIFT

VERSION = 1  # version of frames and messages; a page of another version must be reloaded
STATE, POINTER, ACK, RELEASE, BEAT = 1, 2, 3, 4, 5  # kinds of frames: the first byte
STATE_FRAME = struct.Struct("<BBHIIId15ff8x")
"""Frame to the page, 96 bytes: kind, status, flags, seq, tag, overruns, sample_ms; hand 3, proxy 3, force 3,
velocity 3, force of the other law 3; late_us. Metres, newtons, metres per second, in the picture's frame; the Unix
clock's time."""
# Frame from the page, 32 bytes: kind, buttons, tag, sent_ms, hand 3 (picture's frame, metres).
POINTER_FRAME = struct.Struct("<BBxxIdfff4x")
ACK_FRAME = struct.Struct("<BxxxI")  # frame from the page, 8 bytes: kind, seq of the state that was drawn
RELEASE_FRAME = struct.Struct("<B")  # frame from the page, 1 byte: it releases its hand
BEAT_FRAME = struct.pack("<B", BEAT)  # frame to the page, 1 byte: the program lives
# Bits of `status`: the force loop runs; this page's hand moves it; ticks are recorded.
RUNNING, HOLDING, RECORDING = 1, 2, 4
# Bits of a pointer's buttons: the low ones are buttons, those above identify the message that the loop acted on.
TAG_BITS, BUTTON_BITS = 22, 8
TAGS = (1 << TAG_BITS) - 1
# Mask of a tick's flags that report events; the bits above are the part of a beacon, which an event reports.
FLAG_BITS = (1 << BEACON_SHIFT) - 1
