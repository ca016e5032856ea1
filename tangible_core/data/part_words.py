"""The number by which people know a part or a segment, from 1; labels, and keys of a pipeline file, are from 0."""


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


def name_part(label: int, name: str = "", noun: str = "part") -> str:
    """Name a part or segment in a sentence.

    >>> name_part(5, "helmet"), name_part(6), name_part(0, noun="segment")
    ('part 6 (helmet)', 'part 7', 'segment 1')
    """
    return f"{noun} {shown_number(label)}" + (f" ({name})" if name else "")


def missing_key(key: int | str, count: int, noun: str = "part") -> str:
    """Say that a key of a pipeline file stands for none of `count` parts or segments.

    >>> print(missing_key(7, 4))
    no part has the key 7: the keys of the 4 parts are 0 to 3, and part 1 is key 0
    """
    there = f"the keys of the {count} {noun}s are 0 to {count - 1}" if count > 1 else f"there is one {noun}"
    return f"no {noun} has the key {key}: {there}, and {noun} 1 is key 0"
