"""A stand-in for a maker's library: millimetres and millinewtons, in its own frame.

x to the right, y up, z towards the user. The handle moves on a circle of 20 mm, once a second, under any force.
"""

import math

Triple = tuple[float, float, float]


class Box:
    """A connection to one box, which nobody else can open meanwhile. Raises: OSError if it is not there, or busy."""

    there, busy = True, False

    def __init__(self) -> None:
        if not Box.there or Box.busy:
            raise OSError("busy" if Box.there else "no box")
        Box.busy, self._ms, self.held_mn = True, 0, (0.0, 0.0, 0.0)

    def poll(self) -> tuple[int, Triple]:
        """Return milliseconds since opening, and the handle's place; a millisecond passes. Raises: OSError."""
        if not Box.there:
            raise OSError("no answer")
        self._ms += 1
        turn = 2 * math.pi * self._ms / 1000
        return self._ms, (20 * math.cos(turn), 1.0, 20 * math.sin(turn))

    def push(self, force_mn: Triple) -> None:
        """Hold this force. Raises: OSError."""
        if not Box.there:
            raise OSError("no answer")
        self.held_mn = force_mn

    def shut(self) -> None:
        """Motors off."""
        Box.busy, self.held_mn = False, (0.0, 0.0, 0.0)
