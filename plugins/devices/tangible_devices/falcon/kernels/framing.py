"""Answers extracted from a stream of bytes that may lose bytes and gain others; compiled, so imported in verbs."""

from numba import int64, void

from tangible_core.compiled import KERNEL, njit

from .packet import BYTES, SIZE, START, is_packet

USB_PACKET, STATUS = 64, 2  # bytes of a full-speed packet, and of the FTDI chip's status at its start

FILL, ANSWERS, DROPPED, SEEN, FRESH = range(5)
COUNTS = 5
NEW, DOUBTFUL = 1, 2
"""Elements of `counts`: bytes of an incomplete answer; answers so far; stray bytes so far, and before the newest
answer; state of the newest answer: 0 if it was read, NEW, or DOUBTFUL if stray bytes came before it or with it."""


@njit(void(BYTES, int64[::1]), **KERNEL)
def resume(begun, counts):
    """Drop the bytes before the next `<` after the first byte."""
    start = 1
    while start < SIZE and begun[start] != START:
        start += 1
    for i in range(start, SIZE):
        begun[i - start] = begun[i]
    counts[FILL] = SIZE - start
    counts[DROPPED] += start


@njit(int64(BYTES, int64, BYTES, int64[::1], BYTES), **KERNEL)
def receive(chunk, size, begun, counts, answer):
    """Take in an IN transfer of `size` bytes; copy its newest answer to `answer`, and return the number of answers."""
    completed = 0
    # `begun` holds the bytes since the last `<` that may begin an answer. If 16 of them are not an answer, the search
    # resumes at the next `<` among them, so that a byte too few or too many costs one answer only.
    for i in range(size):
        if i % USB_PACKET < STATUS:
            continue
        begun[counts[FILL]] = chunk[i]
        counts[FILL] += 1
        if begun[0] != START:
            counts[FILL] = 0
            counts[DROPPED] += 1
        elif counts[FILL] == SIZE:
            if is_packet(begun, 0):
                for k in range(SIZE):
                    answer[k] = begun[k]
                completed += 1
                counts[FILL] = 0
            else:
                resume(begun, counts)
    if completed:
        counts[ANSWERS] += completed
        counts[FRESH] = NEW if counts[DROPPED] == counts[SEEN] and not counts[FILL] else DOUBTFUL
        counts[SEEN] = counts[DROPPED]
    return completed
