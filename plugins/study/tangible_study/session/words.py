"""The words for a participant: sentences of each question, and the keys that answer."""

from ..design.study import Comparison
from ..design.trial import Trial

MORE, LESS, EQUAL = "1", "2", "3"
"""Keys of an adjustment."""
QUESTIONS = {
    "rougher": "Which interval was rougher?",
    "higher": "Which interval was higher?",
    "same": "Which interval was not the same as the others?",
    "different": "Were the two intervals the same, or different?",
    "equal": "Was interval 2 equal to interval 1?",
    "name": "Which part was this?",
}
"""Sentences of all questions but that for a rating."""
NAMED = ("name", "different")
"""Questions whose responses are words, each with a number as its key, in the order of the choices."""


def question(trial: Trial, comparison: Comparison) -> str:
    """Return the question after a trial."""
    if trial.question in QUESTIONS:
        return QUESTIONS[trial.question]
    return f"How would you rate {comparison.scale.of}?" if comparison.scale.of else "Which number fits best?"


def choices(trial: Trial, comparison: Comparison) -> dict[str, str]:
    """Return the keys that answer a trial, each with its meaning."""
    if trial.question == "equal":
        return {MORE: "no, it needs more", LESS: "no, it needs less", EQUAL: "yes, it was equal"}
    if trial.question == "different":
        return {"1": "they were the same", "2": "they were different"}
    if trial.question == "name":
        return {str(number): name for number, name in enumerate(trial.choices, 1)}
    if trial.question == "rating":
        ends = comparison.scale.ends or ("", "")
        return dict.fromkeys(trial.choices, "") | {trial.choices[0]: ends[0], trial.choices[-1]: ends[1]}
    return dict.fromkeys(trial.choices, "")


def response(trial: Trial, key: str) -> str:
    """Return the response of a key."""
    return trial.choices[int(key) - 1] if trial.question in NAMED else key


def right_answer(trial: Trial) -> str:
    """Return the right answer of a trial, for training; "" if there is none."""
    if trial.target is not None:
        return trial.target
    if trial.question == "same":
        return str(trial.position)
    if trial.level is None or trial.standard is None or trial.position is None or trial.level == trial.standard:
        return ""
    return str(trial.position if trial.level > trial.standard else 3 - trial.position)
