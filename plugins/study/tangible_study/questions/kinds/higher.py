"""Which of two intervals was higher."""

from ..question import More


class Higher(More):
    """The higher interval."""

    sentence = "Which interval was higher?"
    about = "which interval was higher"


QUESTION = Higher()
