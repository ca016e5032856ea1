import json
import re
import zlib
from base64 import b64decode, b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from page_files import built_page
from sent_pages import HOSTILE, MATERIALS, WIDE_M, finer, picture_to_send
from tangible_core import Pipeline, Scene
from tangible_core.data import Work
from tangible_core.errors import OutputError
from tangible_core.plugins.notes import collect_notes
from tangible_depth import Luminance
from tangible_legibility.words.languages import Language, Words, one_line
from tangible_render.surface.coefficients import spline_coefficients
from tangible_send.packing import MAX_CELLS, MIN_PHOTO, deflate, make_page, surface_to_send
from tangible_send.page import Page
from videos import write_video

pytestmark = pytest.mark.usefixtures("built")


@pytest.fixture(scope="module")
def built() -> None:
    built_page()


class Elements(HTMLParser):
    """The elements of a page, each with its attributes and its text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None], list[str]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs), []))

    def handle_endtag(self, tag: str) -> None:
        self.found.append((f"/{tag}", {}, []))

    def handle_data(self, data: str) -> None:
        if self.found:
            self.found[-1][2].append(data)

    def texts(self, tag: str) -> list[str]:
        return ["".join(text) for name, _, text in self.found if name == tag]


def test_titles_and_names_stay_text(tmp_path: Path):
    title = HOSTILE[0] + HOSTILE[1]
    (path,) = Page().write(picture_to_send(title), tmp_path / "it")
    assert path.name == "it-page.html"
    page = Elements(path.read_text("utf-8"))
    assert [attrs.get("src") for tag, attrs, _ in page.found if tag in ("script", "img")] == [None, None]
    shown = one_line(title)
    assert page.texts("title") == [shown]
    data, script = page.texts("script")
    assert not re.search("[<>&\u2028\u2029]", data)
    meta = json.loads(data)["meta"]
    assert meta["name"] == shown
    assert [each["name"] for each in meta["materials"]] == [each.name for each in MATERIALS]
    assert meta["parts"] == [one_line(each) for each in HOSTILE]
    assert meta["parts"][2] == HOSTILE[2] and HOSTILE[2] in page.texts("bdi")
    assert script == built_page().joinpath("send.js").read_text("utf-8")


def test_policy_allows_this_script_and_style_alone(tmp_path: Path):
    (path,) = Page().write(picture_to_send(), tmp_path / "it")
    page = Elements(path.read_text("utf-8"))
    [policy] = [attrs["content"] for _, attrs, _ in page.found if attrs.get("http-equiv") == "Content-Security-Policy"]
    allowed = dict(word.strip().split(" ", 1) for word in str(policy).split(";"))
    for kind, text in (("script", page.texts("script")[1]), ("style", page.texts("style")[0])):
        assert allowed.pop(f"{kind}-src") == f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
    assert allowed == {
        "default-src": "'none'", "base-uri": "'none'", "form-action": "'none'",
    }  # fmt: skip


@pytest.mark.whole
def test_file_is_as_small_as_is_asked(tmp_path: Path):
    work = finer(picture_to_send(), 8)
    work = replace(work, picture=np.random.default_rng(1).integers(0, 255, (900, 1200, 3), dtype=np.uint8))
    with collect_notes() as notes:
        (path,) = Page(most_bytes=1_200_000).write(work, tmp_path / "it")
    size = path.stat().st_size
    assert 1_000_000 < size <= 1_200_000
    [said] = [note.text for note in notes if "cells" in note.text]
    assert "of 960 x 720" in said and "steps of" in said
    photo = json.loads(Elements(path.read_text("utf-8")).texts("script")[0])["photo"]
    assert Image.open(BytesIO(b64decode(photo))).size[0] > 300
    assert len(photo) > 0.6 * MIN_PHOTO, "the surface leaves room for it"
    with pytest.raises(OutputError, match="make `most_bytes` larger"):
        Page.model_construct(most_bytes=700_000).write(work, tmp_path / "it")


def test_coefficients_are_within_half_a_step():
    work = picture_to_send()
    sent = next(surface_to_send(work))
    assert sent.step_m == 1e-6
    wanted_m = spline_coefficients(work.surface.height_m)
    assert np.abs(sent.coefficients - wanted_m).max() < 0.51e-6


def test_numbers_are_packed_as_the_page_unpacks_them():
    """Unpacked by the rule that stands in the page's `unfold`, one number after the other; labels use all 16 bits."""
    numbers = np.random.default_rng(3).integers(0, 2**16, (7, 5), dtype=np.uint16)
    packed = zlib.decompress(b64decode(deflate(numbers)))
    found = np.zeros((8, 6), np.int64)
    for k in range(35):
        row, column = divmod(k, 5)
        zigzag = packed[k] | packed[35 + k] << 8
        plane = found[row, column + 1] + found[row + 1, column] - found[row, column]
        found[row + 1, column + 1] = (plane + ((zigzag >> 1) ^ -(zigzag & 1))) % 2**16
    assert (found[1:, 1:] == numbers).all()


def data_of(work: Work, folder: Path) -> dict[str, Any]:
    """The data of the page of a picture."""
    (path,) = Page().write(work, folder / "it")
    return json.loads(Elements(path.read_text("utf-8")).texts("script")[0])


def test_data_describe_the_surface_that_is_sent(tmp_path: Path):
    work = picture_to_send()
    meta = data_of(work, tmp_path)["meta"]
    assert (meta["rows"], meta["columns"], meta["labels"]) == (*work.surface.height_m.shape, 3)
    assert meta["extent_m"] == [WIDE_M, WIDE_M * 0.75]
    height_m = next(surface_to_send(work)).height_m
    assert meta["height_m"] == [height_m.min(), height_m.max()]
    assert meta["digest"] != data_of(replace(work, title="other"), tmp_path)["meta"]["digest"]
    assert meta["digest"] != data_of(replace(work, names=("a", "b", "c")), tmp_path)["meta"]["digest"]


def test_surface_without_parts_is_sent_plainly(tmp_path: Path):
    whole = finer(picture_to_send(""), 8)
    bare = replace(whole.surface, labels=None, materials=None, names=None)
    data = data_of(replace(whole, products={"surface": bare, "materials": None}, names=()), tmp_path)
    assert data["labels"] == "" and data["kinds"] == data["meta"]["materials"] == []
    assert (data["meta"]["labels"], data["meta"]["parts"]) == (0, None)
    assert data["rows"] == [[800.0, 0.0, 0.0, 0.0]]
    assert data["meta"]["rows"] * data["meta"]["columns"] == pytest.approx(MAX_CELLS, rel=0.01)


@pytest.mark.parametrize(
    ("named_in", "language"), [("de", "de"), ("de-AT", "de"), ("fr", "fr"), ("en-GB", "en"), ("he", "en")]
)
def test_words_and_title_are_marked_with_their_languages(tmp_path: Path, named_in: str, language: Language):
    """A screen reader speaks each by its mark; words that there are in no language of the names are English."""
    say = Words(language)
    for title, shown in (("Ein Haus", "Ein Haus"), ("", say("untitled"))):
        (path,) = Page().write(replace(picture_to_send(title), language=named_in), tmp_path / "it")
        page = Elements(path.read_text("utf-8"))
        marks = [(tag, attrs["lang"]) for tag, attrs, _ in page.found if "lang" in attrs]
        assert marks == [("html", language), ("h1", named_in if title else language), ("section", language)]
        assert page.texts("title") == page.texts("h1") == [shown]
        assert say("no script") in page.texts("p")


def test_drawn_heights_are_those_of_the_spline():
    from tangible_render.surface.spline import slope

    sent = next(surface_to_send(picture_to_send()))
    rows, columns = sent.height_m.shape
    width_m, length_m = sent.extent_m
    for row, column in ((0, 0), (20, 15), (44, 60), (89, 119)):
        x, y = (column + 0.5) / columns * width_m - width_m / 2, length_m / 2 - (row + 0.5) / rows * length_m
        height_m = slope(sent.coefficients, columns / width_m, rows / length_m, x, y)[0]
        assert sent.height_m[row, column] == pytest.approx(height_m, abs=2e-7)


def test_labels_of_a_reduced_surface_are_where_its_parts_are():
    whole = finer(picture_to_send(), 8)
    sent = next(surface_to_send(whole))
    assert sent.labels is not None and sent.labels.shape < whole.surface.height_m.shape
    for label in (1, 2):
        both = (sent.labels, whole.surface.labels)
        here, there = (np.argwhere(each == label).mean(axis=0) / each.shape for each in both)
        assert here == pytest.approx(there, abs=2 / len(sent.labels))


def test_script_that_would_end_its_element_is_refused():
    for script, style in (("a</SCRIPT>", ""), ("", "a</style")):
        with pytest.raises(ValueError, match="must not end their elements"):
            make_page("title", "en", "en", {}, script, style, "")


def test_film_is_sent_by_its_first_frame(tmp_path: Path):
    first, other = (np.zeros((48, 64, 3), np.uint8) for _ in range(2))
    first[:, 32:], other[:, :32] = 200, 200
    write_video(tmp_path / "film.avi", [first, other, other])
    pipeline = Pipeline(Scene.video(tmp_path / "film.avi"), depth=Luminance())
    with collect_notes() as notes:
        done = pipeline.export(tmp_path / "out", ["page"])
    [path] = done.files["page"]
    page = Elements(path.read_text("utf-8"))
    assert "This is the first frame of a film." in path.read_text("utf-8")
    assert "the page shows the first frame of the film" in str([note.text for note in notes]) + str(done)
    picture = np.asarray(Image.open(BytesIO(b64decode(json.loads(page.texts("script")[0])["photo"]))).convert("L"))
    assert picture[:, :20].mean() < 50 < 150 < picture[:, -20:].mean()
