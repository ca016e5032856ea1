"""Drawings in vectors. Otherwise a shape, a name or a text that a file states would be guessed or lost."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure

from tangible_core import Scene
from tangible_core.drawing import PictureKind, find_ink, find_texts
from tangible_core.errors import ConfigError, PictureError
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.starter import starter
from tangible_core.plugins.registry import default_registry

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
CELL = (
    HEAD
    + """viewBox="0 0 400 300"><title>A plant cell</title><desc>for the test</desc>
<style>/* a note */ .wall, .x {fill:#cfe8c0; stroke:#225522; stroke-width:3} .leader{fill:none;stroke:#000}</style>
<rect width="400" height="300" fill="white"/>
<g aria-label="cell body"><rect class="wall" id="w1" x="30" y="30" width="340" height="240"/></g>
<circle id="nuc" cx="150" cy="140" r="50" fill="#b080c0"><title>nucleus</title></circle>
<circle id="nucleolus" cx="150" cy="140" r="18" style="fill:#603080;opacity:.6"/>
<g id="mitochondrion"><ellipse cx="290" cy="90" rx="40" ry="18"/><ellipse cx="290" cy="220" rx="40" ry="18"/></g>
<ellipse id="path33" cx="120" cy="230" rx="60" ry="25" fill="#88c"/>
<text x="95" y="235" font-size="16">vac<tspan>uole</tspan></text>
<path class="leader" d="M300 20L290 80z"/><circle cx="350" cy="150" r="9" fill="red" fill-opacity="0"/>
<path id="tube" d="M60 60H120" stroke="brown" stroke-width="14"/>
<text x="290" y="16" font-size="14">energy</text><text x="95" y="300">3</text>
<text transform="rotate(-90 20 150)" x="10" y="150" font-size="12">side</text></svg>"""
)


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cell") / "cell.svg"
    path.write_text(CELL)
    return path


@pytest.fixture(scope="module")
def scene(cell: Path) -> Scene:
    return Scene.photo(cell)


def test_shapes_are_segments_with_the_names_that_the_file_gives(scene: Scene):
    labels, names = scene.segments.labels, scene.segment_names
    assert (scene.title, scene.kind.kind, scene.shape) == ("A plant cell", PictureKind.drawing, (1500, 2000))
    assert names == ("", "cell body", "nucleus", "nucleolus", "energy", "mitochondrion", "vacuole", "tube")
    x, y = (np.indices(labels.shape)[::-1] + 0.5) / 5
    away = np.hypot(x - 150, y - 140)
    for name, true in (("nucleolus", away <= 18), ("nucleus", (away <= 50) & (away > 18)), ("tube", labels == 7)):
        mask = labels == names.index(name)
        assert (mask & true).sum() / (mask | true).sum() > 0.998, name
    assert (labels == 7).sum() == pytest.approx(60 * 14 * 25, rel=0.02), "a wide stroke is an area"


def test_texts_are_known_and_out_of_the_picture(scene: Scene):
    assert [text.content for text in scene.texts] == ["vacuole", "energy", "3", "side"]
    assert [text.direction_deg for text in scene.texts] == [0, 0, 0, 90]
    assert scene.texts[0].box == pytest.approx((0.24, 0.745, 0.39, 0.785), abs=0.01)
    assert not find_texts(find_ink(scene.views.left)).boxes
    assert scene.warnings == ("texts of cell.svg that name no part are left out of the relief: 3, side",)


def test_title_of_a_drawing_without_one_is_the_text_above_it(tmp_path: Path):
    texts = '<text x="34" y="9" font-size="7">Fruit</text><text x="80" y="50" font-size="6">5</text>'
    (tmp_path / "f.png").write_text(f'{HEAD}viewBox="0 0 90 60">{texts}<path d="M9 20H60V50H9Z" fill="red"/></svg>')
    scene = Scene.photo(tmp_path / "f.png")
    assert scene.warnings == ("texts of f.png that name no part are left out of the relief: 5",)
    assert scene.title == "Fruit"


def test_crop_and_turn_take_names_and_texts_along(cell: Path):
    scene = Scene.photo(cell, crop=(200, 1000, 1000, 500), rotate=90)
    assert scene.segment_names == ("", "cell body", "vacuole") and scene.shape == (1000, 500)
    text, _ = scene.texts
    column, row = np.array(text.middle) * (500, 1000)
    assert (text.content, text.direction_deg) == ("vacuole", 270)
    assert scene.segments.labels[int(row), int(column)] == 2


def test_starter_names_the_parts_and_the_title(cell: Path):
    config = parse_config(starter([cell], cell.with_suffix(".yaml")).text, cell, default_registry())
    names = ["cell body", "tube", "energy", "nucleus", "nucleolus", "mitochondrion", "vacuole"]
    assert (config.title, list(config.part_names.values())) == ("A plant cell", names)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty"),
        ("hello", "cannot be read as SVG: syntax error"),
        ("<html/>", "cannot be read as SVG: its first element is html"),
        ('<!DOCTYPE s [<!ENTITY a SYSTEM "file:///etc/passwd">]><svg>&a;</svg>', "declares entities"),
        (HEAD + "/>", "shows nothing"),
        (HEAD + 'viewBox="0 0 9 9"><text y="5">hi</text></svg>', "holds only texts"),
        (HEAD + ">" + "<g>" * 300 + "</g>" * 300 + "</svg>", "its groups lie more than 200 deep"),
        (HEAD + "><!--" + "x" * 20_000_000 + "--></svg>", "holds more than 20 MB"),
        (
            HEAD + '><g id="a0"><path d="M0 0H1V1Z"/></g>'
            + "".join(f'<g id="a{i}">' + f'<use href="#a{i - 1}"/>' * 10 + "</g>" for i in range(1, 9)) + "</svg>",
            "nodes limit reached",
        ),
        (
            HEAD + 'viewBox="0 0 9 9"><pattern id="p" width="1e6" height="1e6" patternUnits="userSpaceOnUse"><path '
            'd="M0 0H9V9Z"/></pattern><rect width="9" height="9" fill="url(#p)"/></svg>', "too much memory",
        ),
    ],
)  # fmt: skip
def test_svg_that_cannot_be_a_picture_is_refused_with_the_cure(text: str, said: str, tmp_path: Path):
    (tmp_path / "a.svg").write_text(text)
    with pytest.raises(PictureError, match=rf"a\.svg: .*{said}.*[;,:] .+"):
        Scene.photo(tmp_path / "a.svg")


def test_nothing_outside_of_the_file_is_read(cell: Path):
    from PIL import Image

    Image.new("RGB", (9, 9), "red").save(cell.with_name("red.png"))
    outside = "".join(f'<image href="{name}" width="9" height="9"/>' for name in ("red.png", cell.with_name("red.png")))
    text = f'{HEAD}width="9mm" height="9mm" viewBox="0 0 9 9">{outside}<script>1</script><a href="http://x"/>'
    cell.with_name("out.svg").write_text(f'{text}<line x2="9" y2="9" stroke="#000" stroke-width=".1"/></svg>')
    scene = Scene.photo(cell.with_name("out.svg"))
    colours = scene.views.left.astype(int)
    assert (np.ptp(colours, axis=2) == 0).all() and scene.kind.kind == PictureKind.lines
    assert [warning.split(" in ")[0].split(",")[0] for warning in scene.warnings] == [
        f"out.svg refers to {cell.with_name('red.png')}"[:78], "scripts"
    ]  # fmt: skip


def test_page_of_a_pdf_has_its_texts_beside_the_picture(tmp_path: Path):
    path = tmp_path / "two.pdf"
    with PdfPages(path, metadata={"Title": "Two pages"}) as pages:
        for word in ("apples", "pears"):
            figure = Figure(figsize=(6, 4))
            figure.add_axes((0.25, 0.25, 0.5, 0.5), facecolor="red", xticks=[], yticks=[])
            figure.text(0.5, 0.9, word, size=20, ha="center")
            figure.text(0.5, 0.5, "crate", size=12, ha="center")
            pages.savefig(figure)
    first, second = Scene.photo(path), Scene.photo(path, page=2)
    assert (first.title, first.shape) == ("Two pages", (1334, 2000))
    assert [text.content for text in second.texts] == ["pears", "crate"]
    text, _ = first.texts
    assert text.content == "apples" and text.middle == pytest.approx((0.5, 0.09), abs=0.02)
    assert (first.views.left[:300] == 255).all() and (first.views.left[500, 1000] == (255, 0, 0)).all()
    assert first.warnings == ("two.pdf has 2 pages, of which the first is taken; `page: 2` takes another",)
    config = parse_config(starter([path], tmp_path / "two.yaml").text, path, default_registry())
    assert not second.warnings and (config.title, [*config.part_names.values()]) == ("Two pages", ["crate"])
    with pytest.raises(PictureError, match="has no page 3; its pages are 1 to 2"):
        Scene.photo(path, page=3)
    with pytest.raises(ConfigError, match="page is for a PDF"):
        Scene.photo(tmp_path / "a.png", page=1)
