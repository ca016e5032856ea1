"""A Falcon would be read wrongly or its motors turn the wrong way: the documented packets to the count."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_devices.falcon.kernels import packet

INT16 = st.integers(-32768, 32767)


def as_bytes(text: str) -> np.ndarray:
    return np.frombuffer(bytearray(text.encode("latin-1")), np.uint8)


def sent(first: int, second: int, third: int, info: int = 0) -> bytes:
    buffer = np.zeros(16, np.uint8)
    packet.encode(first, second, third, info, buffer)
    return buffer.tobytes()


@pytest.mark.parametrize(
    ("counts", "digits"),
    [(1447, "HKFA"), (-1447, "JFKP"), (0, "AAAA"), (-1, "PPPP"), (32767, "PPPH"), (-32768, "AAAI"), (-2900, "MKEP")],
)
def test_number_of_documented_digits_is_decoded(counts: int, digits: str):
    assert sent(counts, 0, counts)[1:13].decode() == f"{digits}AAAA{digits}"
    assert packet.decode(as_bytes(f"<{digits}AAAA{digits}AA>")) == (counts, 0, counts, 0)


def test_packet_seen_on_the_wire_is_decoded():
    seen = bytes.fromhex("3c 50 50 50 41 43 45 50 41 43 4d 50 41 45 41 3e")
    assert packet.decode(np.frombuffer(bytearray(seen), np.uint8)) == (4095, 3906, 4034, packet.BLUE)
    assert sent(4095, 3906, 4034, packet.BLUE) == seen


def test_decode_splits_buttons_and_homed_arms():
    assert packet.decode(as_bytes("<AAAAAAAAAAAA\xb1A>"))[3] == packet.HOMED


@given(INT16, INT16, INT16, st.integers(0, 15))
def test_encode_then_decode_gives_the_same(first: int, second: int, third: int, info: int):
    buffer = np.frombuffer(bytearray(sent(first, second, third, info)), np.uint8)
    assert packet.decode(buffer) == (first, second, third, info)
    assert packet.is_packet(buffer, 0)


@pytest.mark.parametrize("at", range(16))
@pytest.mark.parametrize("wrong", [0x00, 0x3D, 0x40, 0xC1, 0xFF])
def test_is_packet_refuses_one_impossible_byte(at: int, wrong: int):
    buffer = as_bytes("<HKFAJFKPAAAA\xb1A>")
    buffer[at] = wrong
    assert packet.is_packet(buffer, 0) == (at == 14)  # the meaning of the byte before the last is unknown


@pytest.mark.parametrize("at", range(1, 13))
def test_is_packet_accepts_sixteen_digits(at: int):
    buffer = as_bytes("<HKFAJFKPAAAA\xb1A>")
    for byte, right in ((0x41, True), (0x50, True), (0x51, False)):
        buffer[at] = byte
        assert packet.is_packet(buffer, 0) == right


@pytest.mark.parametrize("most", [4095.4, 4096.0, 4100.0, 6000.0, 8189.0, 8190.0, 8191.0, 20_000.0, 40_000.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_saturate_scales_torques_slightly_too_large(axis: int, most: float, sign: float):
    """What the device cannot give by a little, and what wraps its sign, alike; the others come down with it."""
    wanted = np.full(3, 0.5 * sign * most)
    wanted[axis] = sign * most
    *counts, factor = packet.saturate(*wanted)
    half = round(0.5 * 4095)
    assert [abs(count) for count in counts] == [
        4095 if each == axis else pytest.approx(half, abs=1) for each in range(3)
    ]
    assert np.array_equal(np.sign(counts), [sign] * 3)
    assert factor == pytest.approx(4095 / most)


@pytest.mark.parametrize("most", [0.4, 1.0, 4094.4, 4095.0])
def test_saturate_keeps_torques_within_limits(most: float):
    assert packet.saturate(most, -most, 0.0) == (round(most), -round(most), 0, 1.0)


@given(*[st.floats(-1e6, 1e6)] * 3)
def test_saturate_keeps_direction(first: float, second: float, third: float):
    *counts, factor = packet.saturate(first, second, third)
    assert np.allclose(counts, np.multiply((first, second, third), factor), atol=0.5)
    assert factor == 1 or max(map(abs, counts)) == packet.MAX_COUNTS


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_saturate_nonfinite_torques_gives_zero(bad: float):
    assert packet.saturate(100.0, bad, 100.0) == (0, 0, 0, 0.0)
