"""A position that was never sent would be taken from a damaged stream."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from falcon_streams import GAINED, LOST, NOISE, SWAPPED, buffers, fuzz
from tangible_devices.falcon.kernels import framing, packet, tick

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
