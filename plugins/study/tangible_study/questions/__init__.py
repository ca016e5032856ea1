"""The kinds of question: a file each in `kinds/`, and its name in `points.py`."""

from functools import cache
from importlib import import_module

from .question import Question


@cache
def load_question(name: str) -> Question:
    """Return the kind of question of this name, one of `points.QUESTIONS`."""
    question: Question = import_module(f".kinds.{name}", __package__).QUESTION
    return question
