"""Which making is the newest, which are at work, and which were stopped."""

from typing import final


@final
class Makes:
    """Long jobs are numbered: a newer one takes the place of those before it."""

    def __init__(self) -> None:
        self.newest = 0
        self.running: set[int] = set()
        """Numbers of those that somebody waits for."""
        self.apply_after = False
        """Whether to look, after the one at work, if what was edited meanwhile can be applied at once."""
        self.killed = False
        """Whether the maker was killed for an earlier one: if the newest met the one that died, it is asked again."""

    def begin(self) -> int:
        """The number of another one."""
        self.newest += 1
        self.running.add(self.newest)
        return self.newest

    def stop(self) -> None:
        """None of those at work is wanted any more."""
        self.newest += 1
        self.killed, self.apply_after = True, False
