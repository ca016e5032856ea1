"""Which of two intervals was rougher."""

from ..question import More


class Rougher(More):
    """The rougher interval."""

    sentence = "Which interval was rougher?"
    about = "which interval was rougher"


QUESTION = Rougher()
