"""Parts and segments have one number for people: their label plus one."""

from tangible_core.data.part_words import label_of_number, shown_number


def test_shown_number_counts_from_one_and_back():
    assert [shown_number(label) for label in range(3)] == [1, 2, 3]
    assert [label_of_number(shown_number(label)) for label in range(3)] == [0, 1, 2]
