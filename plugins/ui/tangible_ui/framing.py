"""The binary frames of the websocket, little-endian; a test compares them with the page, web/src/server/protocol.ts."""

import struct

from tangible_core.data.ticks import BEACON_SHIFT

VERSION = 1
"""Of frames and messages; a page of another one is told to load again."""
STATE, POINTER, ACK, RELEASE = 1, 2, 3, 4
"""The first byte of a frame: its kind."""
STATE_FRAME = struct.Struct("<BBHIIId15ff8x")
"""To the page, 96 bytes: kind, status, flags, seq, tag, overruns, sample_ms; hand 3, proxy 3, force 3, velocity 3,
force of the other law 3; late_us. Metres, newtons, metres per second, in the picture's frame; the Unix clock's time."""
POINTER_FRAME = struct.Struct("<BBxxIdfff4x")
"""From the page, 32 bytes: kind, buttons, tag, sent_ms, hand 3. The hand is in the picture's frame, metres."""
ACK_FRAME = struct.Struct("<BxxxI")
"""From the page, 8 bytes: kind, seq; this state was drawn."""
RELEASE_FRAME = struct.Struct("<B")
"""From the page, 1 byte: its hand lets go."""
RUNNING, HOLDING, RECORDING = 1, 2, 4
"""Bits of `status`: the force loop runs; this page's hand is the one that is felt; ticks are being kept."""
TAG_BITS, BUTTON_BITS = 22, 8
"""A pointer's buttons travel through the loop's ring; the bits above the real ones say which message was acted on."""
TAGS = (1 << TAG_BITS) - 1
FLAG_BITS = (1 << BEACON_SHIFT) - 1
"""Of a tick's flags, those that say what happened; above them stands the part of a beacon, which an event tells."""
