"""The place at which a participant sits: sentences to hear, and keys that answer."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from threading import Event
from typing import IO, final

from tangible_core.pipeline import Feeling
from tangible_core.runtime.system import forget_typed
from tangible_core.servo import Servo

LEAVE = "q"  # key that leaves the study; it goes on later with --resume


class ParticipantLeft(Exception):
    """The participant left; what was answered is kept."""


class Desk(ABC):
    """A place at which a participant hears what to do, and answers by keys."""

    @property
    @abstractmethod
    def stop(self) -> Event:
        """An event that ends the force at once, when the participant sets it."""

    @abstractmethod
    def say(self, text: str) -> None:
        """Say a text; it does not wait."""

    @abstractmethod
    def ask(self, text: str, choices: Mapping[str, str]) -> str:
        """Ask, and return the key that answers; choices: meaning of each key, "" is Enter. Raises: ParticipantLeft."""

    def exploring(self, feeling: Feeling, servo: Servo, part: str | None) -> AbstractContextManager[None]:
        """Return a block in which a surface can be felt. part: to which the hand is led. Raises: DeviceError."""
        return nullcontext()


@final
class Terminal(Desk):
    """A terminal: each text is a line, and each answer is a key and Enter, so that a screen reader reads it all."""

    def __init__(self, keys: IO[str], write: Callable[[str], None], translate: Callable[[str], str]) -> None:
        """keys: of the keyboard. write: prints a line. translate: to the language of the participant."""
        self._keys, self._write, self._translate = keys, write, translate
        self._stop = Event()

    @property
    def stop(self) -> Event:
        return self._stop

    def say(self, text: str) -> None:
        self._write(self._translate(text))

    def ask(self, text: str, choices: Mapping[str, str]) -> str:
        keys = [f"{key} = {self._translate(meaning)}" if meaning else key for key, meaning in choices.items() if key]
        options = f" ({', '.join(keys)})" if keys else ""
        self._write(f"{self._translate(text)}{options}")
        if self._keys.isatty():
            forget_typed(self._keys)
        while True:
            line = self._keys.readline()
            key = line.strip().casefold()
            if not line or key == LEAVE:
                raise ParticipantLeft
            if key in choices:
                return key
            self.say("That key has no meaning here.")
            self._write(f"{self._translate(text)}{options}")
