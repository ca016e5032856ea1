"""Drawings: kinds told apart, areas, lines and texts found, on drawings made by code in styles that chose nothing.

`python -m benchmarks.drawings FOLDER` draws the pictures of docs/how-to/drawings.md.
"""

import os
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import cv2
import numpy as np
import shapely

from tangible_core import Pipeline, Scene
from tangible_core.data import SegmentMap, Views
from tangible_core.drawing import DrawnPicture, PictureKind, find_areas, find_marks, picture_kind
from tangible_core.drawing.labels import texts_in, tie_texts
from tangible_core.parts import find_parts
from tangible_core.pipeline.part_names import picture_texts
from tangible_core.pipeline.starter import suited_config
from tangible_core.plugins.registry import default_registry
from tangible_core.relief import ReliefChoice, edge_relief, line_relief
from tangible_core.scene.workspace import Workspace
from tangible_export.braille import height_m
from tangible_export.paper.marks import reading
from tangible_export.paper.sheet import GAP_MM, sheet_for
from tangible_legibility.legible import legibility
from tangible_networks.reading import read_texts

from .drawings_made import Made, made_drawings
from .figures import Figure, judged, part

COUNT = int(os.environ.get("TANGIBLE_DRAWINGS", "200"))  # how many drawings of each kind
PHOTOS = os.environ.get("TANGIBLE_PHOTOGRAPHS", "")  # a folder of photographs
CHUNK = 20  # how many drawings a process makes at a time
FEW = 48  # how many drawings are measured area by area and line by line
OVERLAP = 0.7


def section() -> str:
    """Return the section as Markdown."""
    head = (
        f"Drawings made by code: {COUNT} of each kind for kinds, {FEW} for all else; JPEG, noise, tint, blur, shadow "
        "and tilt. Weights and bounds were chosen on other contents and copies (`benchmarks/drawings_made.py`)."
    )
    made = (_kinds, _areas, _lines, _dashed, _texts, _labels, _page, _pages)
    figures = [figure for make in made for figure in part(make.__name__.strip("_"), make)]
    return "\n".join([head, "", *judged(figures)])


def _kinds() -> Iterator[Figure]:
    kinds, seeds = ("drawing", "lines", "text"), range(COUNT // CHUNK)
    with ProcessPoolExecutor(2 * (os.cpu_count() or 1)) as pool:
        found = {kind: pool.map(_count_right, [kind] * len(seeds), seeds) for kind in kinds}
        counted = {kind: np.sum(list(each), axis=0) for kind, each in found.items()}
    for kind, (right, _) in counted.items():
        share = right / COUNT
        yield Figure(f"kind right: {kind}", ">= 0.97", f"{share:.3f}", share >= 0.97)
    seconds = sum(each[1] for each in counted.values()) / (COUNT * len(kinds))
    yield Figure("processor time for a kind", "<= 0.3 s", f"{seconds:.2f} s", seconds <= 0.3)
    photos = [path for end in ("jpg", "png") for path in Path(PHOTOS).rglob(f"*.{end}")] if PHOTOS else []
    if photos:
        taken = sum(picture_kind(cv2.imread(str(photo))[..., ::-1]).likely != "photograph" for photo in photos)
        share = f"{taken} of {len(photos)}"
        yield Figure("photographs taken for a drawing", "<= 1 %", share, taken <= 0.01 * len(photos))


def _count_right(kind: str, seed: int) -> tuple[int, float]:
    cv2.setNumThreads(1)
    right, seconds = 0, 0.0
    for made in made_drawings("told", kind, CHUNK, seed):
        start = process_time()
        right += picture_kind(made.picture).likely == kind
        seconds += process_time() - start
    return right, seconds


def _areas() -> Iterator[Figure]:
    sums = np.zeros(6)
    for made in made_drawings("told", "drawing", FEW):
        sums += score_areas(made)
    found, true, edge = sums[0] / sums[1], sums[2] / sums[3], sums[4] / sums[5]
    yield Figure("areas found, overlap over 0.7", ">= 0.97", f"{found:.3f}", found >= 0.97)
    yield Figure("areas true", ">= 0.97", f"{true:.3f}", true >= 0.97)
    yield Figure("edges off, mean", "<= 0.3 px", f"{edge:.2f} px", edge <= 0.3)


def score_areas(made: Made) -> np.ndarray:
    """Return areas found and all, true and all found ones, pixels beyond edges, and the edges' length."""
    known = made.labels >= 0
    unknown, by_pixel = (~known).astype(np.uint8), cv2.DIST_LABEL_PIXEL
    nearest = cv2.distanceTransformWithLabels(unknown, cv2.DIST_L2, 5, labelType=by_pixel)[1].astype(np.int32)
    at = np.zeros(int(nearest.max()) + 1, np.int64)
    at[nearest[known]] = np.flatnonzero(known)
    truth = made.labels.reshape(-1)[at[nearest]]
    areas = find_areas(made.picture)
    true, found = _pieces(truth), _pieces(areas.labels)
    both = np.zeros((true.max() + 1, found.max() + 1))
    np.add.at(both, (true[known], found[known]), 1)
    overlap = (both / np.maximum(both.sum(1, keepdims=True) + both.sum(0, keepdims=True) - both, 1))[1:, 1:] > OVERLAP
    bare, length = np.zeros(known.shape, np.uint8), 0.0  # edges without a line on them
    for first, second in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
        change = known[first] & known[second] & (truth[first] != truth[second])
        bare[second] |= change
        length += np.pi / 4 * change.sum()  # by Crofton: crossings of a grid in two directions
    matched = np.argmax(both, axis=1)[true]
    near = cv2.dilate(bare, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (9, 9))) > 0
    wrong = near & known & (matched != found) & np.isin(true, 1 + np.flatnonzero(overlap.any(1)))
    matches = overlap.any(1).sum(), len(overlap), overlap.any(0).sum(), overlap.shape[1]
    return np.array([*matches, wrong.sum(), length])


def _pieces(labels: np.ndarray) -> np.ndarray:
    pieces, count = np.zeros(labels.shape, np.int32), 0
    for label in np.unique(labels):
        number, of, about, _ = cv2.connectedComponentsWithStats((labels == label).astype(np.uint8), connectivity=4)
        for each in range(1, number):
            if about[each, cv2.CC_STAT_AREA] >= (max(labels.shape) / 60) ** 2:
                count += 1
                pieces[of == each] = count
    return pieces


def _lines() -> Iterator[Figure]:
    sums, raised = np.zeros(4), np.zeros(3)
    for number, made in enumerate(made_drawings("told", "lines", FEW)):
        sums += score_lines(made)
        if number < 8:
            raised += _raised(made, _centre(made))
    for name, share in (("found within 0.5 mm", sums[0] / sums[1]), ("true", sums[2] / sums[3])):
        yield Figure(f"length of lines {name}", ">= 0.95", f"{share:.3f}", share >= 0.95)
    before, now = raised[1] / raised[0], raised[2] / raised[0]
    yield Figure("lines raised by 1 mm; before, by edges", ">= 0.95", f"{now:.3f}; {before:.3f}", now >= 0.95)
    flat = {True: np.zeros(4), False: np.zeros(4)}
    for made in made_drawings("told", "drawing", 2 * FEW):
        flat[made.style.endswith(("jpeg 50", "scan"))] += score_lines(made)
    for jpeg, (found, drawn, true, every) in flat.items():
        shares = f"{true / every:.3f}; {found / drawn:.3f}"
        name = f"lines on flat drawings with{'' if jpeg else 'out'} JPEG: true; found"
        yield Figure(name, ">= 0.95; >= 0.95", shares, min(true / every, found / drawn) >= 0.95)


def _dashed() -> Iterator[Figure]:
    shares = list[tuple[float, float]]()
    for made in made_drawings("told", "dashed", FEW):
        ways = [line.way for line in find_marks(made.picture).lines.dashed]
        true, found = _centre(made), _centre(replace(made, lines=ways))
        near = [cv2.dilate(one.astype(np.uint8), np.ones((5, 5))) > 0 for one in (true, found)]
        shares.append((near[1][true].mean(), near[0][found].mean() if ways else 1.0))
    for name, least, share in zip(("found", "true"), (0.8, 0.98), np.transpose(shares), strict=True):
        error = share.std() / len(share) ** 0.5
        measured = f"{share.mean():.3f} ± {error:.3f}"
        yield Figure(f"length of dashed lines {name}", f">= {least}", measured, share.mean() >= least)


def _centre(made: Made) -> np.ndarray:
    drawn = np.zeros(made.picture.shape[:2], np.uint8)
    for line in made.lines:
        cv2.polylines(drawn, [np.rint(line).astype(np.int32)], False, 1)
    return drawn > 0


def score_lines(made: Made) -> np.ndarray:
    """Return the lines' pixels that are found and all, and the found ones that are true and all but missed letters."""
    centre, drawn = find_marks(made.picture).lines.centre, _centre(made)
    reach = max(1.5, 0.0005 * made.picture.shape[1] / 0.16)  # 0.5 mm of 160 mm
    near = [cv2.distanceTransform((~one).astype(np.uint8), cv2.DIST_L2, 5) <= reach for one in (centre, drawn)]
    counted = centre.copy()
    for box in made.texts:
        left, top, right, bottom = (max(0, round(edge)) for edge in box)
        counted[top:bottom, left:right] = False
    true = (centre & near[1]).sum()
    return np.array([(drawn & near[0]).sum(), drawn.sum(), true, true + (counted & ~near[1]).sum()])


def _raised(made: Made, drawn: np.ndarray) -> np.ndarray:
    views, size = Views(made.picture), Workspace().size("lines")
    edges = edge_relief(views, size, ReliefChoice(by="edges")).height_m
    lines, _ = line_relief(views, size, ReliefChoice(by="lines"), areas=False)
    up = [(height_m[drawn] > np.median(height_m) + 0.001).sum() for height_m in (edges, lines.height_m)]
    return np.array([drawn.sum(), *up])


def _texts() -> Iterator[Figure]:
    found = count = false = boxes = 0
    for kind in ("drawing", "lines"):
        for made in made_drawings("told", kind, FEW):
            ink, texts = find_marks(made.picture).ink, find_marks(made.picture).texts
            near = np.zeros(ink.mask.shape, np.bool_)
            for box in made.texts:
                left, top, right, bottom = (max(0, round(edge)) for edge in box)
                own = ink.mask[top:bottom, left:right]
                found += bool(own.any()) and texts.ink[top:bottom, left:right][own].mean() > OVERLAP
                near[top:bottom, left:right] = True
            for text in texts.boxes:
                at = np.array(text[:4]) * np.tile(ink.mask.shape[::-1], 2)
                left, top, right, bottom = np.rint(at).astype(int)
                false += not near[top:bottom, left:right].any()
            count, boxes = count + len(made.texts), boxes + len(texts.boxes)
    yield Figure("labels found", ">= 0.95", f"{found / count:.3f}", found / count >= 0.95)
    yield Figure("places taken for a text without one", "<= 0.02", f"{false / boxes:.3f}", false / boxes <= 0.02)


def _labels() -> Iterator[Figure]:
    wrong = tied = missed = letters = 0
    around, beside = np.zeros((2, 2), np.int64)
    for made in made_drawings("told", "drawing", FEW):
        parts = find_parts(SegmentMap(find_areas(made.picture).labels)).labels
        marks = find_marks(made.picture)
        texts, size = texts_in(marks), np.tile(made.picture.shape[1::-1], 2)
        read_ones = read_texts(made.picture, texts)
        for read, part_number in zip(read_ones, tie_texts(marks.lines.centre, read_ones, parts), strict=True):
            (column, row), at = read.middle * size[:2], np.array(made.texts).reshape(-1, 4)
            own = np.flatnonzero((at[:, 0] <= column) & (at[:, 2] >= column) & (at[:, 1] <= row) & (at[:, 3] >= row))
            if not own.size:
                continue
            if read.content:
                missed += _edits(read.content, made.words[own[0]])
                letters += len(made.words[own[0]])
            area = -1 if part_number is None else _area(made.labels[parts == part_number])
            counts = beside if made.style.startswith("pie") else around
            counts += made.names[own[0]] >= 0, made.names[own[0]] == area >= 0
            tied, wrong = tied + (area >= 0), wrong + (made.names[own[0]] != area >= 0)
    share = around[1] / around[0]
    yield Figure("labels tied to the part around them or at their line", ">= 0.95", f"{share:.3f}", share >= 0.95)
    yield Figure("labels tied to the slice beside them", "", f"{beside[1] / beside[0]:.3f}", True)
    yield Figure("ties to another part", "<= 0.02", f"{wrong / tied:.3f}", wrong / tied <= 0.02)
    if letters:
        share = 1 - missed / letters
        yield Figure("characters read right, by the network", ">= 0.97", f"{share:.3f}", share >= 0.97)


def _area(labels: np.ndarray) -> int:
    counts = np.bincount(labels[labels >= 0], minlength=1)
    return int(counts.argmax()) if counts.any() else -1


def _edits(one: str, other: str) -> int:
    """Return the least number of letters to put in, take out or change; Levenshtein, 1966."""
    before = list(range(len(other) + 1))
    for row, letter in enumerate(one, 1):
        now = [row]
        for column, wanted in enumerate(other, 1):
            now.append(min(now[-1] + 1, before[column] + 1, before[column - 1] + (letter != wanted)))
        before = now
    return before[-1]


def _page() -> Iterator[Figure]:
    """Yield the processor time from a drawing of 4 megapixels to its page, all modules imported and nothing cached."""
    from tangible_texture import Flat

    small, *_ = made_drawings("told", "drawing", 1)
    rows, columns = small.picture.shape[:2]
    factor = (4e6 / (rows * columns)) ** 0.5
    large = cv2.resize(small.picture, (round(columns * factor), round(rows * factor)), interpolation=cv2.INTER_CUBIC)
    for picture in (small.picture, large):
        start = process_time()
        with TemporaryDirectory() as folder:
            pipeline = Pipeline(Scene.photo(picture), texture=Flat(), title="Map", cached=False)
            (page,) = pipeline.export(folder, ["swell"]).exports
        seconds = process_time() - start
    written = page.outcome.outcome == "ran"
    yield Figure("4 Mpx drawing to swell page", "<= 5 s", f"{seconds:.1f} s", written and seconds <= 5)


def _pages() -> Iterator[Figure]:
    with ProcessPoolExecutor() as pool:
        rows = np.array([*pool.map(_score_page, ["drawing"] * 40 + ["lines"] * 20, [*range(40), *range(20)])])
    good, silent = rows.sum(axis=0).tolist()
    name = "legible swell pages of 60 drawings, nothing dropped unsaid; the same without lines or texts called legible"
    yield Figure(name, "60; 0", f"{good}; {silent}", good == len(rows) and not silent)


def _score_page(kind: str, number: int) -> tuple[bool, bool]:
    """Return whether a page is legible and names what it lacks, and whether it would be without lines or texts."""
    made = [*made_drawings("told", kind, number + 1)][number]
    config = suited_config([Scene.photo(made.picture)], default_registry()).with_values(title="Map")
    engine = (pipeline := Pipeline.from_config(config, default_registry(), None)).engine
    with TemporaryDirectory() as folder:
        [page] = pipeline.export(folder, ["swell"]).exports
        svgs = [path.read_text() for path in page.files if "ink" not in path.name and path.suffix == ".svg"]
    size, whole, texts = made.picture.shape[1::-1], engine.make("parts"), picture_texts(engine.scene, engine.registry)
    sheet = sheet_for("a4", size[0] / size[1], None).below(1000 * height_m())
    marks = [mark for mark in reading.read(svgs[0]).marks if mark.what in ("line", "outline")]
    drawn = shapely.union_all([shapely.linestrings(mark.shape.vertices) for mark in marks]).buffer(GAP_MM)
    lines = shapely.MultiLineString([at / size * sheet.picture_mm + (sheet.left_mm, sheet.top_mm) for at in made.lines])
    labels = re.findall('aria-label="([^"]*)"', "".join(svgs))
    said = " ".join(["Map", *(note.text for note in page.outcome.notes), *labels])
    shares = np.bincount(whole.labels.ravel()) / whole.labels.size if kind == "drawing" else np.zeros(0)
    names = [config.part_names.get(part, f"part {part + 1}") for part in np.flatnonzero(shares > 0.001).tolist()]
    unsaid = [name for name in [*names, *(text.content for text in texts)] if name not in said]
    kept = lines.difference(drawn).length <= 0.1 * lines.length and (not unsaid or " more" in said)
    bare = DrawnPicture(PictureKind(kind), made.picture, True, whole, texts, len(texts))
    cases = [bare] * bool(texts) + [bare._replace(lines=False, lost_texts=())] * bool(made.lines)
    silent = [legibility("swell", whole, sheet.picture_mm[0] / 1000, drawing=case).readable for case in cases]
    return page.legible is not None and page.legible.readable and kept, any(silent)


def pictures(folder: Path) -> None:
    """Write a drawing of each kind beside its relief by edges, as before, and by lines, as now."""
    from tangible_texture import Flat

    folder.mkdir(exist_ok=True)
    for kind, number in (("lines", 0), ("drawing", 1), ("drawing", 2)):
        made = list(made_drawings("chosen", kind, number + 1))[number]
        scene, shown = Scene.photo(made.picture, kind=kind), [made.picture]
        for by in ("edges", "lines"):
            relief = Pipeline(scene, relief=by, texture=Flat()).relief
            slopes = np.gradient(relief.height_m, relief.pitch_m[0])
            light = np.clip((0.7 + 0.45 * (slopes[0] + slopes[1])) * 200, 0, 255).astype(np.uint8)
            shown.append(light[..., None].repeat(3, 2))
        small = [cv2.resize(each, (400, round(400 * each.shape[0] / each.shape[1]))) for each in shown]
        name = made.style.split(",")[0]
        cv2.imwrite(str(folder / f"{name}.png"), np.concatenate(small, axis=1)[..., ::-1])


if __name__ == "__main__":
    pictures(Path(sys.argv[1]))
