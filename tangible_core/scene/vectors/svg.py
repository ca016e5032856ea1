"""SVG: the picture, and what its shapes and texts say."""

import json
import re
import subprocess
from base64 import b64decode
from collections import defaultdict
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from math import atan2, degrees
from pathlib import Path
from typing import Any, cast
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Bool, Int32, UInt8

from ...data import PictureText
from ...data.pictures import fill_from_nearest
from ...drawing import PictureKind, find_marks
from ...drawing.labels import tie_texts, title_among
from ...errors import PictureError, shown
from ...files.reading import in_words
from ...runtime.child_process import python
from ...runtime.opencv import cv2, plain_opencv
from ..formats.multi_picture import Notify, ignore
from .page import SIDE_PX, VectorPage, rank_labels
from .tree import HIDE, Item, cut_off, find_items, find_label, local, walk, words_in

MAX_BYTES = 20_000_000
"""The most bytes of an SVG: what is larger is a scan, or a map of a whole country."""
MAX_SHAPES = 4096  # the most shapes that are parts: more are a texture
# The least piece of a shape that shows; what is smaller is a gap between two others.
MIN_PIECE_PX = 25
# The side of the least square that shows as a shape without a name, by the longer side: a speck, or a letter.
LEAST = 1 / 60
STROKE = 1 / 55  # the width from which a stroke is an area, as a share of the longer side
MAX_SECONDS, MAX_MEMORY = 60, 4 << 30  # the limits of drawing, s and bytes
CHILD = """import base64, json, {0} as resvg
from tangible_core.runtime.system.processes import limit_memory
limit_memory({1})
print(json.dumps([base64.b64encode(resvg.svg_to_bytes(**call)).decode() for call in json.load(sys.stdin)]))"""
"""The program that renders."""
LARGER = 1.5  # the least ratio of the height of a text that names a part to those of others in it
PLAIN = "*{opacity:1!important;fill-opacity:1!important;stroke-opacity:1!important;filter:none!important;" \
    "mask:none!important;mix-blend-mode:normal!important;marker:none!important;marker-start:none!important;" \
    "marker-mid:none!important;marker-end:none!important;shape-rendering:crispEdges!important}"  # fmt: skip
"""Rules under which each pixel has the colour of one shape alone."""


def read_svg(path: Path, data: bytes, notify: Notify = ignore) -> VectorPage:
    """Read an SVG; its texts name the shapes in which they lie, and are left out. Raises: PictureError."""
    root = _parse(path, data)
    outside, runs = cut_off(root)
    if outside:
        notify(f"{path.name} refers to {', '.join(sorted(outside)[:3])}, which is not read; embed it in the file")
    if runs:
        notify(f"scripts in {path.name} are not run; if they draw something, save the drawing as it is shown")
    shapes, texts = find_items(root)
    flat = _flat_styles(root, shapes, texts) if len(shapes) <= MAX_SHAPES else []
    text_styles = [_text_styles(shapes, texts)] if texts else []
    ways = [{text.element: HIDE for text in texts}, *flat, *text_styles]
    try:
        pixels, *layers = _render([_styled(root, styles) for styles in ways])
    except ValueError as error:
        raise _unreadable(path, str(error)) from error
    if not pixels[..., 3].any():
        what = "holds only texts, which fingers cannot read as a picture; write them in braille" if texts else (
            "shows nothing; check that the drawing is not hidden or outside of the page"
        )  # fmt: skip
        raise PictureError(f"{path}: {what}")
    alpha = pixels[..., 3:].astype(np.float32) / 255
    picture = np.rint(pixels[..., :3] * alpha + 255 * (1 - alpha)).astype(np.uint8)
    labels = _labels(layers[0], layers[1], shapes, picture) if flat else None
    known_texts = _read_texts(layers[-1], texts) if texts else ()
    names: tuple[str, ...] = ()
    if labels is None:
        notify(f"{path.name} has more than {MAX_SHAPES} shapes, which is a texture: its parts are found by colour")
    else:
        labels, names = _name_shapes(labels, shapes, known_texts, _leader_lines(labels, layers[2], shapes))
    loose = [text for text in known_texts if text.content not in names]
    title = find_label(root) or title_among(loose)
    if unused := [text.content for text in loose if text.content != title]:
        notify(f"texts of {path.name} that name no part are left out of the relief: {shown(', '.join(unused))}")
    raster = any(local(element) == "image" and "href" in "".join(element.attrib) for element, _, _ in walk(root))
    kind = PictureKind.drawing if labels is None or labels.any() else PictureKind.lines
    return VectorPage(picture, labels, names, known_texts, title, None if raster else kind)


def _parse(path: Path, data: bytes) -> Element:
    if len(data) > MAX_BYTES:
        raise PictureError(
            f"{path}: holds more than {in_words(MAX_BYTES)}, which is too much for a drawing; simplify its "
            "paths, or save it as PNG"
        )
    if b"<!ENTITY" in data or b"\0" in data:  # UTF-16 would hide them
        raise PictureError(f"{path}: declares entities, which are not read; save it as plain SVG in UTF-8")
    try:
        root = ElementTree.fromstring(data)  # there are no entities, and it loads nothing
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise _unreadable(path, str(error)) from error
    if local(root) != "svg":
        raise _unreadable(path, f"its first element is {local(root)[:40]}")
    try:
        for _ in walk(root):
            pass
    except ValueError as error:
        raise _unreadable(path, str(error)) from error
    return root


def _unreadable(path: Path, why: str) -> PictureError:
    return PictureError(f"{path}: cannot be read as SVG: {why}; save it again as plain SVG, or as PNG")


def _styled(root: Element, styles: Mapping[Element, str]) -> str:
    """Return the text of the tree with further styles of its elements."""
    before = {element: element.get("style", "") for element in styles}
    try:
        for element, style in styles.items():
            element.set("style", (before[element] + style).lstrip(";"))
        return ElementTree.tostring(root, encoding="unicode")
    finally:
        for element, style in before.items():
            element.set("style", style)


def _render(texts: Sequence[str]) -> list[UInt8[np.ndarray, "h w 4"]]:
    """Render documents, SIDE_PX long: the first as it is, the others in flat colours. Raises: ValueError."""
    # A process of its own does it, since the library ends it where memory is lacking, and a drawing may take hours.
    import resvg_py

    matplotlib = find_spec("matplotlib")  # which has a font, the same on every system; it is not imported
    fonts = [] if matplotlib is None else matplotlib.submodule_search_locations or []
    font = str(Path(*fonts, "mpl-data", "fonts", "ttf", "DejaVuSans.ttf"))
    families = dict.fromkeys(("font_family", "serif_family", "sans_serif_family", "monospace_family"), "DejaVu Sans")
    every = {"dpi": 96, "width": SIDE_PX, "height": SIDE_PX, "skip_system_fonts": True, "font_files": [font]} | families
    sheets = [None, *[PLAIN] * (len(texts) - 1)]
    calls = [{"svg_string": text, "style_sheet": sheet, **every} for text, sheet in zip(texts, sheets, strict=True)]
    try:
        result = subprocess.run(
            python(CHILD.format(resvg_py.__name__, MAX_MEMORY)), input=json.dumps(calls), timeout=MAX_SECONDS,
            capture_output=True, text=True, encoding="utf-8", check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        raise ValueError(f"it takes more than {MAX_SECONDS} s to draw") from error
    if result.returncode:
        messages = re.findall(r"^ValueError: (.*)$", result.stderr, re.MULTILINE)
        raise ValueError(messages[-1] if messages else "it takes too much memory to draw")
    pictures = list[UInt8[np.ndarray, "h w 4"]]()
    with plain_opencv():
        for png in json.loads(result.stdout):
            pixels = cv2.imdecode(np.frombuffer(b64decode(png), np.uint8), cv2.IMREAD_UNCHANGED)
            pictures.append(np.asarray(pixels, np.uint8)[..., [2, 1, 0, 3]])
    return pictures


def _numbers(pixels: UInt8[np.ndarray, "h w 4"], count: int) -> Int32[np.ndarray, "h w"]:
    """Return the numbers that are painted as colours; 0 elsewhere."""
    red, green, blue, alpha = np.moveaxis(pixels.astype(np.int32), 2, 0)
    numbers = red << 16 | green << 8 | blue
    return np.where((alpha == 255) & (numbers <= count), numbers, 0)


def _flat_styles(root: Element, shapes: list[Item], texts: list[Item]) -> list[dict[Element, str]]:
    """Return the styles by which each shape is its number as a colour: without strokes, with them, and undashed."""
    hidden = {text.element: HIDE for text in texts}
    hidden |= {element: HIDE for element, _, _ in walk(root) if local(element) == "image"}
    fills, drawn, whole = dict(hidden), dict(hidden), dict(hidden)
    for number, shape in enumerate(shapes, 1):
        paint, none = f"#{number:06x}!important", "none!important"
        fill = f";fill:{paint if shape.filled else none};stroke:"
        fill = f";fill-rule:evenodd!important{fill}" if shape.outline else fill
        fills[shape.element] = fill + none
        drawn[shape.element] = fill + (paint if shape.stroked else none)
        whole[shape.element] = drawn[shape.element] + ";stroke-dasharray:none!important"
    return [fills, drawn, whole]


def _labels(
    fills: UInt8[np.ndarray, "h w 4"], drawn: UInt8[np.ndarray, "h w 4"], shapes: list[Item], picture: np.ndarray
) -> Int32[np.ndarray, "h w"]:
    """Return the number of the shape, from 1, that covers each pixel; 0 for the ground."""
    # A stroke is an area only where it is wide. Letters that are drawn as shapes go to what is around them.
    from skimage.measure import label  # pyright: ignore[reportMissingTypeStubs, reportUnknownVariableType]

    labels, whole = _numbers(fills, len(shapes)), _numbers(drawn, len(shapes))
    side = round(STROKE * max(labels.shape)) | 1
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))
    with plain_opencv():
        wide = np.asarray(cv2.morphologyEx((whole != labels).astype(np.uint8), cv2.MORPH_OPEN, disc)) > 0
    labels = np.where(wide, whole, labels)
    pieces = np.asarray(label(labels, connectivity=1, background=-1), np.int32)
    letters_mask = find_marks(picture).texts.ink.astype(np.uint8)
    with plain_opencv():
        letters = cv2.resize(letters_mask, labels.shape[::-1], interpolation=cv2.INTER_NEAREST)
    size = np.bincount(pieces.reshape(-1))
    shape_of = np.zeros(size.size, np.int32)
    shape_of[pieces.reshape(-1)] = labels.reshape(-1)
    least_px = (LEAST * max(labels.shape)) ** 2
    least = np.array([MIN_PIECE_PX, *(MIN_PIECE_PX if shape.label else least_px for shape in shapes)])
    large = (size >= least[shape_of]) & (2 * np.bincount(pieces.reshape(-1), letters.reshape(-1)) < size)
    valid_mask: Bool[np.ndarray, "h w"] = large[pieces]
    return labels if valid_mask.all() or not valid_mask.any() else fill_from_nearest(labels, valid_mask)


def _text_styles(shapes: list[Item], texts: list[Item]) -> dict[Element, str]:
    """Return the styles by which each text is its number, from 1, as a colour."""
    styles = {shape.element: HIDE for shape in shapes}
    for number, text in enumerate(texts, 1):
        for element, _, _ in walk(text.element):
            styles[element] = f";fill:#{number:06x}!important;stroke:none!important"
    return styles


def _read_texts(pixels: UInt8[np.ndarray, "h w 4"], texts: list[Item]) -> tuple[PictureText, ...]:
    """Return what the texts say, and where; those that are not shown are left out."""
    numbers = _numbers(pixels, len(texts))
    shown_texts, (rows, columns) = list[PictureText](), numbers.shape
    for number, (down, across) in enumerate(_places(numbers, len(texts)), 1):
        content = " ".join(words_in(texts[number - 1].element).split())
        if content and down.stop:
            box = across.start / columns, down.start / rows, across.stop / columns, down.stop / rows
            shown_texts.append(PictureText(content, box, _direction(texts[number - 1].element)))
    return tuple(shown_texts)


def _places(numbers: Int32[np.ndarray, "h w"], count: int) -> list[tuple[slice, slice]]:
    """Return the rows and columns of each number; empty slices for one that is nowhere."""
    from scipy import ndimage  # pyright: ignore[reportMissingTypeStubs]

    slices: list[tuple[slice, slice] | None] = cast(Any, ndimage).find_objects(numbers, max_label=count)
    return [place or (slice(0, 0), slice(0, 0)) for place in slices]


def _direction(element: Element) -> float:
    """Return the direction of a text by its own turn, degrees counterclockwise."""
    if match := re.search(r"rotate\(\s*(-?[\d.]+)", element.get("transform", "")):
        return -float(match[1]) % 360
    match = re.search(r"matrix\(\s*(-?[\d.]+)[\s,]+(-?[\d.]+)", element.get("transform", ""))
    return -degrees(atan2(float(match[2]), float(match[1]))) % 360 if match else 0.0


def _name_shapes(
    labels: Int32[np.ndarray, "h w"], shapes: list[Item], texts: tuple[PictureText, ...], lines: np.ndarray
) -> tuple[Int32[np.ndarray, "h w"], tuple[str, ...]]:
    """Return labels from 0, each of them present, and their names. lines: centre lines by which texts are tied."""
    present, labels = rank_labels(labels)
    tied = defaultdict[int | None, list[PictureText]](list)
    for text, place in zip(texts, tie_texts(lines, texts, labels), strict=True):
        tied[place].append(text)
    names = ["" for number in present if number == 0]  # the ground comes first
    for place in range(len(names), len(present)):
        shape = shapes[present[place] - 1]
        names.append(shape.label or _largest(tied[place]) or shape.name)
    return labels, tuple(names)


def _leader_lines(
    labels: Int32[np.ndarray, "h w"], drawn: UInt8[np.ndarray, "h w 4"], shapes: list[Item]
) -> Bool[np.ndarray, "h w"]:
    """Return the centre lines of strokes that bound nothing, and are too thin to be areas."""
    from skimage.morphology import skeletonize  # pyright: ignore[reportMissingTypeStubs, reportUnknownVariableType]

    numbers, is_line = _numbers(drawn, len(shapes)), [False, *(shape.stroked and not shape.filled for shape in shapes)]
    return np.asarray(skeletonize(np.array(is_line)[numbers] & (labels != numbers)), np.bool_)


def _largest(texts: Sequence[PictureText]) -> str:
    """Return the text that is clearly the largest; "" if there is none."""
    tall = sorted(((text.box[3] - text.box[1], text.content) for text in texts), reverse=True)
    return tall[0][1] if len(tall) == 1 or (tall and tall[0][0] > LARGER * tall[1][0]) else ""
