"""Texts name the parts in which they lie or to which they point; else a cell's nucleus is called its wall."""

import cv2
import numpy as np
import pytest

from tangible_core import Scene
from tangible_core.data import PictureText
from tangible_core.drawing import find_marks
from tangible_core.drawing.labels import texts_in, tie_texts
from tangible_core.pipeline import part_names
from tangible_core.pipeline.starter import suited_config
from tangible_core.plugins.registry import default_registry

PAPER, CELL, NUCLEUS = range(3)


def cell(turn_deg: float = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return a cell with `wall` in it, `core` beside it with a leader line, and `note` on the paper; and its parts."""
    picture = np.full((400, 700, 3), 255, np.uint8)
    parts = np.zeros((400, 700), np.int32)
    for number, radius, colour in ((CELL, 150, (150, 210, 240)), (NUCLEUS, 50, (240, 160, 90))):
        for target, value in ((picture, colour), (parts, number)):
            cv2.circle(target, (250, 200), radius, value, -1)
        cv2.circle(picture, (250, 200), radius, (20, 20, 20), 2)
    cv2.line(picture, (250, 200), (510, 190), (20, 20, 20), 2)
    for word, at in (("wall", (215, 310)), ("core", (525, 197)), ("note", (560, 370))):
        cv2.putText(picture, word, at, cv2.FONT_HERSHEY_SIMPLEX, 0.7, (20, 20, 20), 2, cv2.LINE_AA)
    turn = cv2.getRotationMatrix2D((350, 200), turn_deg, 1)
    parts = cv2.warpAffine(parts, turn, (700, 400), flags=cv2.INTER_NEAREST)
    return cv2.warpAffine(picture, turn, (700, 400), borderValue=(255, 255, 255)), parts


@pytest.mark.parametrize("turn_deg", [0, 6])
def test_text_names_the_part_around_it_or_at_the_end_of_its_leader_line(turn_deg):
    picture, parts = cell(turn_deg)
    marks = find_marks(picture)
    texts = texts_in(marks)
    tied = dict(zip((text.middle for text in texts), tie_texts(marks.lines.centre, texts, parts), strict=True))
    assert [tied[place] for place in sorted(tied, key=lambda place: place[0])] == [CELL, NUCLEUS, None]
    assert all(abs(text.direction_deg - turn_deg) < 8 for text in texts if text.direction_deg)


@pytest.mark.parametrize(("share", "named"), [(0.55, 1), (0.45, None)])
def test_text_names_a_part_that_has_half_of_it(share, named):
    parts = np.zeros((100, 100), np.int32)
    parts[30:70, 10 : 10 + round(80 * share)] = 1
    parts[30:70, 10 + round(80 * share) : 80] = 2
    text = PictureText("", (0.1, 0.4, 0.9, 0.6))
    assert tie_texts(np.zeros((100, 100), bool), [text], parts) == (named,)


def test_text_names_the_bar_beside_it_unless_it_is_a_value_the_title_or_between_two():
    parts = np.zeros((300, 300), np.int32)
    for number, left in enumerate((40, 120, 200), 1):
        parts[100:250, left : left + 40] = number
    at = {"Rome": (45, 258), "12": (125, 85), "Oslo": (125, 258), "Rain": (130, 20), "mm": (150, 60), "Both": (85, 150)}
    texts = [PictureText(word, (x / 300, y / 300, (x + 30) / 300, (y + 14) / 300)) for word, (x, y) in at.items()]
    texts.append(PictureText("up", (205 / 300, 255 / 300, 215 / 300, 290 / 300), 90))
    tied = tie_texts(np.zeros((300, 300), bool), texts, parts)
    assert dict(zip((text.content for text in texts), tied, strict=True)) == {
        **dict.fromkeys(("12", "Rain", "mm", "Both", "up")),
        "Rome": 1,
        "Oslo": 2,
    }


def test_leader_line_that_stops_at_an_outline_names_what_is_behind_it():
    picture, parts = cell()
    picture[:, 403:][parts[:, 403:] == PAPER] = 255
    picture[:, 100:400] = np.where(parts[:, 100:400, None] == PAPER, 255, picture[:, 100:400])
    cv2.line(picture, (402, 200), (510, 200), (20, 20, 20), 2)
    cv2.putText(picture, "cell", (525, 207), cv2.FONT_HERSHEY_SIMPLEX, 0.7, (20, 20, 20), 2, cv2.LINE_AA)
    marks = find_marks(picture)
    texts = [text for text in texts_in(marks) if text.middle[0] > 0.7]
    assert tie_texts(marks.lines.centre, texts, parts) == (CELL,)


def test_starter_names_parts_as_a_network_reads_them(monkeypatch):
    def read(picture: np.ndarray, texts: list[PictureText]) -> list[PictureText]:
        words = {"wall": 0.36, "core": 0.79, "note": 0.84}
        near = [min(words, key=lambda word: abs(words[word] - text.middle[0])) for text in texts]
        return [PictureText(word, text.box) for word, text in zip(near, texts, strict=True)]

    registry, picture = default_registry(), cell()[0]
    scene = Scene.photo(picture, kind="drawing")
    assert not suited_config([scene], registry).parts, "nobody reads"
    monkeypatch.setattr(part_names, "networks_identity", lambda registry, task: task)
    monkeypatch.setattr(part_names, "read_function", lambda registry: read)
    assert set(suited_config([scene], registry).part_names.values()) == {"wall", "core"}
    assert not suited_config([Scene.photo(picture, kind="photograph")], registry).parts
