"""Answers by what they are about: participants, conditions, levels."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import TypeVar

from ..trials import Answer

Key = TypeVar("Key", bound=Hashable)
ByParticipant = Mapping[str, Sequence[Answer]]
"""Answers of one comparison by participant."""


def grouped(answers: Sequence[Answer], key: Callable[[Answer], Key]) -> dict[Key, list[Answer]]:
    """Return answers by a key, in the order of the first of each."""
    groups: dict[Key, list[Answer]] = {}
    for answer in answers:
        groups.setdefault(key(answer), []).append(answer)
    return groups


def label(answer: Answer) -> str:
    """Return the condition of an answer, with its level if one varies."""
    return answer.condition if answer.level is None else f"{answer.condition} at {answer.level:g}"


def together(answers: ByParticipant) -> list[Answer]:
    """Return the answers of all participants."""
    return [each for one in answers.values() for each in one]
