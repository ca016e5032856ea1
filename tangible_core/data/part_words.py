"""The number of a part or a segment, from 1 in texts, pictures and files; labels in arrays are from 0."""

FROM_ONE = "from 1, as on the sheet of a run (an older file, with numbers from 0, needs 1 more in each)"
"""The cure of a number below 1."""


def shown_number(label: int) -> int:
    """Return the number of a part or segment for people, in every text, picture and list.

    >>> shown_number(0)
    1
    """
    return label + 1


def label_of_number(number: int) -> int:
    """Return the label of the part or segment that people know by this number.

    >>> label_of_number(1)
    0
    """
    return number - 1


def check_number(number: int) -> int:
    """Return the number of a part or segment in a file. Raises: ValueError for one below 1."""
    if number < 1:
        raise ValueError(f"Input should be a number {FROM_ONE}")
    return number


def name_part(label: int, name: str = "", noun: str = "part") -> str:
    """Name a part or segment in a sentence.

    >>> name_part(5, "helmet"), name_part(6), name_part(0, noun="segment")
    ('part 6 (helmet)', 'part 7', 'segment 1')
    """
    return f"{noun} {shown_number(label)}" + (f" ({name})" if name else "")


def missing_number(number: int | str, count: int, noun: str = "part") -> str:
    """Say that a number of a pipeline file stands for none of `count` parts or segments.

    >>> print(missing_number(7, 4))
    there is no part 7: the 4 parts are numbered from 1 to 4
    """
    there = f"the {count} {noun}s are numbered from 1 to {count}" if count > 1 else f"{noun} 1 is the only one"
    return f"there is no {noun} {number}: {there}"
