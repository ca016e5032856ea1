"""Labels of parts in files and notes."""

from tangible_core.data import Work
from tangible_export.labels import first_labels, label_of


def test_labels_are_listed_once_and_the_others_counted():
    assert first_labels("abacbdef") == "a, b, c, d, e, f"
    assert first_labels("abacbdefg") == "a, b, c, d, e, f and 1 more"


def test_label_of_part_without_name_is_its_number_in_the_language():
    work = Work("Map", "de", {}, None, ("sea", " "))
    assert [label_of(number, work) for number in range(3)] == ["sea", "Teil 2", "Teil 3"]
