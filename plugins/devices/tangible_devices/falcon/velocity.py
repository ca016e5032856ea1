"""How fast an encoder turns, out of whole counts; compiled.

Imports numba: a method imports this module inside its verb. numba's cache does not see a change made in another file:
after an edit here, remove `__pycache__` beside the kernels that call it.
"""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles

from numba import float64, int64, njit

from .packet import COMPILED

BAND_COUNTS = 1.0
"""A line may be so far from a sample: an encoder rounds."""


@njit(float64(float64[:, ::1], int64, int64, int64), **COMPILED)
def rate(history, head, samples, column):
    """Counts per second at the newest sample: the slope over the longest window that is straight within the band.

    history: a ring of rows (time in seconds, counts of three encoders); head: the newest; samples: how many there are.
    Slow motion is seen over many samples and so without the noise of single counts, fast motion over few and so
    without delay. Every sample between the ends of the window is within one count of the line through them; the slopes
    for which this is so are narrowed down sample by sample.
    Source: Janabi-Sharifi, Hayward & Chen, Discrete-time adaptive windowing for velocity estimation, IEEE Trans.
    Control Systems Technology 8(6), 2000, sec. III (end-fit).
    """
    now, last = history[head, 0], history[head, column]
    low, high, slope = -float("inf"), float("inf"), 0.0
    at = head
    for _ in range(samples - 1):
        at = at - 1 if at else history.shape[0] - 1
        since, rise = now - history[at, 0], last - history[at, column]
        if not (since > 0.0 and low * since <= rise <= high * since):
            break
        slope = rise / since
        low, high = max(low, (rise - BAND_COUNTS) / since), min(high, (rise + BAND_COUNTS) / since)
    return slope
