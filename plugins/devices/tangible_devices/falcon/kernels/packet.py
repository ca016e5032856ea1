"""The 16 bytes to and from a running Falcon; compiled, so imported in verbs.

`<`, 14 bytes of 0x41 + value, `>`. Three signed 16-bit numbers as four nibbles each, the least significant one first;
then lights and homing (out), or buttons and homed arms (in); then one byte of unknown meaning.
Source: libnifalcon, FalconFirmwareNovintSDK.cpp.
"""

from numba import boolean, float64, int64, types, uint8, void

from tangible_core.compiled import KERNEL, njit

SIZE = 16
START, END, ZERO = 0x3C, 0x3E, 0x41  # `<`, `>`, and `A`, which stands for 0
INFO = 13  # index of the byte of lights and homing (out), of buttons and homed arms (in)
HOMING, GREEN, BLUE, RED = 0x01, 0x02, 0x04, 0x08  # bits of that byte, outwards
# Bits of that byte, inwards: four buttons; the arms that found their zero: top, right, left.
BUTTONS, HOMED = 0x0F, 0x70
# Greatest torque that the original driver sends; beyond 32767 the sign would wrap.
MAX_COUNTS = 4095

BYTES, FEW = uint8[::1], types.UniTuple(int64, 3)


@njit(boolean(BYTES, int64), **KERNEL)
def is_packet(stream, at):
    """Tell whether the 16 bytes from here are an answer: frame and digits in their ranges. There is no checksum."""
    if stream[at] != START or stream[at + SIZE - 1] != END:
        return False
    for i in range(1, INFO):
        if stream[at + i] - ZERO > 15 or stream[at + i] < ZERO:
            return False
    return 0 <= stream[at + INFO] - ZERO <= BUTTONS + HOMED


@njit(int64(BYTES, int64), **KERNEL)
def number(packet, at):
    """Return the signed 16-bit number of the four digits from here."""
    value = 0
    for i in range(4):
        value |= (int64(packet[at + i]) - ZERO & 15) << 4 * i
    return value - 0x10000 if value > 0x7FFF else value


@njit(types.UniTuple(int64, 4)(BYTES), **KERNEL)
def decode(packet):
    """Return (encoder 1, encoder 2, encoder 3, buttons and homed arms) of an answer."""
    return number(packet, 1), number(packet, 5), number(packet, 9), int64(packet[INFO]) - ZERO & 0xFF


@njit(void(int64, int64, int64, int64, BYTES), **KERNEL)
def encode(first, second, third, info, packet):
    """Write a packet to the device: three torques in counts, within 16 bits, and lights and homing."""
    packet[0], packet[SIZE - 1] = START, END
    for i in range(4):
        packet[1 + i] = ZERO + (first >> 4 * i & 15)
        packet[5 + i] = ZERO + (second >> 4 * i & 15)
        packet[9 + i] = ZERO + (third >> 4 * i & 15)
    packet[INFO], packet[INFO + 1] = ZERO + (info & 15), ZERO


@njit(types.Tuple((int64, int64, int64, float64))(float64, float64, float64), **KERNEL)
def saturate(first, second, third):
    """Return torques in whole counts, 0 if not finite, and the one factor that keeps all within MAX_COUNTS."""
    largest = max(abs(first), abs(second), abs(third))
    if not abs(first) + abs(second) + abs(third) < float("inf"):
        return 0, 0, 0, 0.0
    # One factor for all three keeps the direction of the force.
    factor = MAX_COUNTS / largest if largest > MAX_COUNTS else 1.0
    return int64(round(first * factor)), int64(round(second * factor)), int64(round(third * factor)), factor
