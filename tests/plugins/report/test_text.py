"""The exporter of words: if a case fails, parts are missing, in a false language, or unreadable on an embosser."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tangible_core import Pipeline, Scene
from tangible_core.data import Figure, HapticSurface, MaterialMap, PartMap, PictureText, Work
from tangible_core.errors import BrailleError
from tangible_core.materials.assignment import library
from tangible_core.plugins.notes import collected
from tangible_core.scene.workspace import Workspace
from tangible_depth import Luminance
from tangible_export.braille import as_ascii, translate
from tangible_report import Text

LABELS = np.repeat(np.arange(4, dtype=np.int32), 16).reshape(8, 8)
MATERIALS = tuple(library()[name] for name in ("ice", "wood", "sand", "glass"))


def work(*names: str, title: str = "Le lac", language: str = "fr", simplified: np.ndarray | None = LABELS) -> Work:
    """Four strips from top to bottom, each 1 mm higher than the one before."""
    surface = HapticSurface.from_heights(1e-3 * LABELS, 0.08, LABELS, MATERIALS)
    return Work(
        title,
        language,
        {
            "surface": replace(surface, names=names) if names else surface,
            "simplified": None if simplified is None else PartMap(simplified, (0, 1, 2, 3)),
            "materials": MaterialMap(MATERIALS, ("",) * 4),
        },
        np.zeros((8, 8, 3), np.uint8),
        names,
    )


def write_texts(given: Work, exporter: Text, folder: Path) -> tuple[dict[str, str], list[str]]:
    """The texts by the endings of their files, and the notes."""
    with collected() as notes:
        files = exporter.write(given, folder / "lac")
    return {path.suffix: path.read_bytes().decode() for path in files}, notes


def items(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.startswith("- ")]


def test_text_describes_named_or_simplified_parts(tmp_path: Path):
    merged = np.where(LABELS < 2, 0, 3).astype(np.int32)
    texts, notes = write_texts(work("ciel", "", "île", "eau", simplified=merged), Text(), tmp_path)
    assert texts.keys() == {".txt", ".html"}
    assert [item.split(".")[0] for item in items(texts[".txt"])] == ["- eau", "- île", "- partie 2", "- ciel"]
    assert "Le long du bord inférieur" in items(texts[".txt"])[0]
    assert '<html lang="fr">' in texts[".html"]
    assert notes == []
    texts, notes = write_texts(work(simplified=merged), Text(), tmp_path)
    assert [item[:11] for item in items(texts[".txt"])] == ["- partie 4.", "- partie 1."]
    assert notes == ["no part has a name, so parts are described by number; `tangible parts` shows them for naming"]
    texts, notes = write_texts(work(simplified=None), Text(), tmp_path)
    assert items(texts[".txt"]) == [] and "<ul>" not in texts[".html"] and notes == []
    assert "4 matières" in texts[".txt"]


@pytest.mark.parametrize(("language", "says"), [("en", "Oslo. About 30 on the scale."), ("de", "Skala etwa 30.")])
def test_text_says_what_the_bars_of_a_chart_stand_for(tmp_path: Path, language: str, says: str):
    labels = np.zeros((100, 100), np.int32)
    labels[50:90, 40:50], labels[30:90, 60:70] = 1, 2
    surface = HapticSurface.from_heights(1e-3 * labels, 0.08, labels)
    axis = [PictureText(str(n), (0.1, 0.88 - n / 50, 0.2, 0.92 - n / 50)) for n in (0, 10, 20)]
    products = {"surface": replace(surface, names=("", "Rome", "Oslo")), "materials": None, "simplified": None}
    chart = Work("Rain", language, products, np.zeros((100, 100, 3), np.uint8), ("", "Rome", "Oslo"), texts=tuple(axis))
    texts, _ = write_texts(chart, Text(), tmp_path)
    assert says in items(texts[".txt"])[0] and "etwa" not in items(texts[".txt"])[2]


def test_text_counts_the_people_that_networks_see_in_front(tmp_path: Path):
    figure, faces = np.ones((8, 8), np.float32), np.zeros((2, 468, 3), np.float32)
    for seen, says in (
        (Figure(figure, None, faces), "2 people are in front of the ground."),
        (Figure(figure, None, faces[:1]), "One person is in front of the ground."),
        (Figure(figure), ""),
        (Figure(None, None, faces), ""),
    ):
        given = replace(work(language="en"), extras={"figure": seen})
        for text in write_texts(given, Text(), tmp_path)[0].values():
            assert says in text
            assert bool(says) == ("in front" in text)


def test_text_is_in_the_language_of_the_pipeline_and_exported(tmp_path: Path):
    names = "ciel", "lac", "île", "eau"
    texts, _ = write_texts(work(*names), Text(language="de"), tmp_path)
    assert "- eau. Am unteren Rand entlang." in texts[".txt"]
    assert '<html lang="de">' in texts[".html"] and '<span lang="fr" dir="auto">eau</span>' in texts[".html"]
    texts, notes = write_texts(work(*names, language="pt-BR"), Text(), tmp_path)
    assert "- eau. Along the bottom." in texts[".txt"]
    assert '<html lang="en">' in texts[".html"] and '<h1><span lang="pt-BR" dir="auto">Le lac</span>' in texts[".html"]
    assert notes == ["described in English: there are no words for the language 'pt-BR'; there are for en, de and fr"]
    picture = np.repeat(np.linspace(0, 255, 64).astype(np.uint8)[:, None], 96, axis=1)
    scene = Scene.photo(picture, segments=np.repeat(np.arange(2), 32)[:, None].repeat(96, axis=1))
    pipeline = Pipeline(
        scene, depth=Luminance(), workspace=Workspace(width_m=0.08), title="Rampe", language="de",
        parts={1: "oben", 2: "unten"},
    )  # fmt: skip
    export = pipeline.export(tmp_path, [Text(width_m=0.24)])
    [[text, _]] = [each.files for each in export.exports]
    lines = text.read_text().splitlines()
    assert lines[0] == "Rampe"
    assert lines[2].startswith("Eine Fläche, 240 mm breit und 160 mm lang")
    assert [item[:9] for item in items(text.read_text())] == ["- unten. ", "- oben. A"]


def test_braille_has_the_lines_and_pages_of_embossers(tmp_path: Path):
    exporter = Text(braille=True, cells=20, lines=6)
    texts, [*_, note] = write_texts(work("ciel", "lac", "île", "eau"), exporter, tmp_path)
    assert note.startswith("braille by ")
    pages = texts[".brf"].split("\f")
    assert len(pages) > 2
    assert all(page.endswith("\r\n") and page.count("\r\n") == 6 for page in pages[:-1])
    lines = texts[".brf"].replace("\f", "").split("\r\n")
    assert max(map(len, lines)) <= 20
    first, *later = (line for line in lines if line)
    assert first == as_ascii(translate("Le lac", "fr"))
    starts = [line for line in later if not line.startswith(" ")]
    assert sum(line.startswith(as_ascii(translate("- ", "fr"))) for line in starts) == 4
    assert all(line.startswith("  ") for line in later if line not in starts)
    told = texts[".txt"].splitlines()
    assert 1 + len(starts) == sum(map(bool, told)), "a line begins at the margin for each line of the text"
    assert lines[:-1].count("") == told.count("") > 0


def test_name_without_braille_is_refused_for_braille_only(tmp_path: Path):
    given = work("ciel", "湖", "île", "eau")
    assert "湖" in write_texts(given, Text(), tmp_path)[0][".txt"]
    with pytest.raises(BrailleError, match="'湖'"):
        write_texts(given, Text(braille=True), tmp_path)
