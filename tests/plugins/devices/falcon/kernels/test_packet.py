"""A Falcon would be read wrongly, its motors turn the wrong way, or a position come from a damaged stream."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from falcon_streams import GAINED, LOST, NOISE, SWAPPED, buffers, fuzz
from tangible_devices.falcon.kernels import framing, packet, tick

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


STREAMS = 30_000


@pytest.mark.parametrize(("kinds", "damage"), [(LOST, 0.02), (GAINED, 0.02), (LOST, 0.5), (GAINED, 0.5), (NOISE, 0.0)])
def test_receive_of_damaged_stream_gives_only_sent_positions(kinds: int, damage: float):
    taken, wrong, _, late = fuzz(STREAMS, kinds, damage, 1, tuple(buffers()))
    assert taken >= 2 * STREAMS
    assert (wrong, late) == (0, 0)


@pytest.mark.parametrize("kinds", [SWAPPED, LOST | GAINED, LOST | GAINED | SWAPPED])
def test_receive_of_swapped_digits_gives_bounded_errors(kinds: int):
    taken, wrong, worst_counts, late = fuzz(STREAMS, kinds, 0.02, 2, tuple(buffers()))
    assert wrong <= 0.005 * taken and late <= 1e-3 * STREAMS
    assert worst_counts <= 2 * tick.FAR_COUNTS


def answer(first: int, second: int, third: int, info: int = packet.HOMED) -> bytes:
    buffer = np.zeros(16, np.uint8)
    packet.encode(first, second, third, 0, buffer)
    buffer[packet.INFO] = packet.ZERO + info
    return buffer.tobytes()


class Receiver:
    def __init__(self) -> None:
        self.begun, self.answer = np.zeros(16, np.uint8), np.zeros(16, np.uint8)
        self.counts = np.zeros(framing.COUNTS, np.int64)

    def __call__(self, payload: bytes) -> int:
        packets = b"".join(b"\x01\x60" + payload[at : at + 62] for at in range(0, len(payload), 62)) or b"\x01\x60"
        chunk = np.frombuffer(bytearray(packets.ljust(512, b"\0")), np.uint8)
        return framing.receive(chunk, len(packets), self.begun, self.counts, self.answer)


@given(st.lists(st.integers(1, 62), min_size=1, max_size=30))
def test_receive_joins_answers_from_any_pieces(sizes: list[int]):
    stream, receiver, answers = b"".join(answer(n, -n, 2 * n) for n in range(20)), Receiver(), 0
    for size in sizes:
        answers += receiver(stream[:size])
        stream = stream[size:]
    answers += receiver(stream)
    assert answers == 20
    assert receiver.answer.tobytes() == answer(19, -19, 38)
    assert receiver.counts[framing.DROPPED] == 0


def test_receive_after_stray_bytes_marks_answer_doubtful():
    receiver = Receiver()
    receiver(answer(1, 2, 3))
    assert receiver.counts[framing.FRESH] == framing.NEW
    for strange in (b"?" + answer(1, 2, 3), answer(1, 2, 3) + b"?", answer(1, 2, 3) + b"<"):
        receiver(strange)
        assert receiver.counts[framing.FRESH] == framing.DOUBTFUL
    receiver(answer(1, 2, 3))
    receiver(answer(1, 2, 3))
    assert receiver.counts[framing.FRESH] == framing.NEW
