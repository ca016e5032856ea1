"""Drawings made by code, with their truth: line art, flat drawings and pages of text in many styles.

Half of the families of contents and of the ways of copying are for choosing, `"chosen"`, and the others for measuring.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import cycle
from typing import Any

import cv2
import numpy as np
import shapely
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont
from shapely.ops import substring

FINER = 4  # the factor by which a picture is drawn larger before it is reduced, which smooths its edges
SEEN = 0.9  # the share of a text from which on it is one; of others too much is painted over
SIDES = (640, 1000)  # the least and the most pixels of a side
WORDS = ["river", "stone", "cloud", "Paris", "leaf", "root", "Nile", "cell", "wall", "Monday", "glass"]
WORDS += ["12", "40", "map", "north", "bridge", "A", "B", "km", "window", "tree"]
FONTS = {"chosen": ("DejaVu Sans", "STIXGeneral"), "told": ("DejaVu Serif", "DejaVu Sans Mono", "cmr10")}


@dataclass
class Made:
    """A picture with its truth."""

    picture: np.ndarray
    kind: str
    style: str
    labels: np.ndarray
    """The number of the area of each pixel, int32; -1 for lines and letters."""
    lines: list[np.ndarray] = field(default_factory=list)
    """Centre lines, (n, 2) of x and y in pixels."""
    widths: list[float] = field(default_factory=list)
    texts: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Boxes of texts: left, top, right, bottom."""
    words: list[str] = field(default_factory=list)
    """What the texts say."""
    names: list[int] = field(default_factory=list)
    """The number of the area that each text names; -1 without one."""


class Paper:
    """A picture while it is drawn; lengths in its pixels, drawn finer."""

    def __init__(self, rng: np.random.Generator, half: str, paper: tuple[int, int, int] = (255, 255, 255)) -> None:
        self.rng, self.half = rng, half
        self.width, self.height = (int(side) for side in rng.integers(*SIDES, 2))
        self.fine = np.full((self.height * FINER, self.width * FINER, 3), paper, np.uint8)
        self.areas = np.zeros(self.fine.shape[:2], np.int32)
        self.letters = np.zeros(self.fine.shape[:2], np.uint8)
        self.sizes: list[int] = []
        self.last = 0
        self.made = Made(self.fine, "", "", self.areas)

    def area(self, points: np.ndarray, colour: Any) -> None:
        """Fill a polygon, which is an area of its own."""
        at = [np.rint(points * FINER).astype(np.int32)]
        cv2.fillPoly(self.fine, at, tuple(int(each) for each in colour))
        cv2.fillPoly(self.areas, at, self.last + 1)
        cv2.fillPoly(self.letters, at, 0)
        self.last += 1

    def line(self, points: np.ndarray, width: float, ink: Any, *, closed: bool = False) -> None:
        """Draw a line, and keep it."""
        points = np.concatenate([points, points[:1]]) if closed else points
        at, thick = [np.rint(points * FINER).astype(np.int32)], max(1, round(width * FINER))
        cv2.polylines(self.fine, at, False, tuple(int(each) for each in ink), thick)
        cv2.polylines(self.areas, at, False, -1, thick)
        cv2.polylines(self.letters, at, False, 0, thick)
        self.made.lines.append(np.asarray(points, float))
        self.made.widths.append(width)

    def text(self, words: str, x: float, y: float, size: float, ink: Any, name: int = -1) -> float:
        """Write words with their upper left corner here, and return their width; name: the area that they name."""
        family = FONTS[self.half][int(self.rng.integers(len(FONTS[self.half])))]
        font = ImageFont.truetype(font_manager.findfont(family), round(size * FINER))
        left, top, right, bottom = (each / FINER for each in font.getbbox(words))
        if x + right >= self.width - 2 or y + bottom >= self.height - 2 or x < 0 or y < 0:
            return right
        number = len(self.made.texts) + 1
        for target, value in ((self.fine, tuple(map(int, ink))), (self.areas, -1), (self.letters, number)):
            box = np.s_[int(y * FINER) : int((y + bottom + 2) * FINER), int(x * FINER) : int((x + right + 2) * FINER)]
            mask = Image.new("L", (target[box].shape[1], target[box].shape[0]))
            ImageDraw.Draw(mask).text((0, 0), words, fill=255, font=font)
            target[box][np.asarray(mask) > 127] = value
        self.made.texts.append((x + left, y + top, x + right, y + bottom))
        self.made.words.append(words)
        self.made.names.append(name)
        self.sizes.append(int((self.letters == number).sum()))
        return right

    def finished(self, kind: str, style: str) -> Made:
        """Reduce the picture to its size."""
        picture = cv2.resize(self.fine, (self.width, self.height), interpolation=cv2.INTER_AREA)
        labels = self.areas[FINER // 2 :: FINER, FINER // 2 :: FINER]
        left = np.bincount(self.letters.ravel(), minlength=len(self.sizes) + 1)[1:]
        seen = [number for number, size in enumerate(self.sizes) if left[number] >= SEEN * size]
        every = self.made.texts, self.made.words, self.made.names
        texts, words, names = ([values[number] for number in seen] for values in every)
        made = replace(self.made, picture=picture, kind=kind, style=style, texts=texts, words=words, names=names)
        return replace(made, labels=np.ascontiguousarray(labels))


def _blob(rng: np.random.Generator, x: float, y: float, radius: float, rough: float = 0.25) -> np.ndarray:
    turn = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    waves = sum(rng.normal() / n * np.cos(n * turn + rng.uniform(0, 6.3)) for n in range(2, 6))
    reach = radius * (1 + rough * 0.5 * waves)
    return np.stack([x + reach * np.cos(turn), y + reach * np.sin(turn)], axis=1)


def _box(x: float, y: float, width: float, height: float) -> np.ndarray:
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], float)


def _palette(rng: np.random.Generator, count: int) -> np.ndarray:
    while True:
        colours = rng.integers(40, 236, (count, 3))
        every = np.concatenate([colours, [(255, 255, 255), (0, 0, 0)]])
        apart = np.abs(every[:, None] - every[None]).sum(axis=2) + 999 * np.eye(len(every))
        if apart.min() > (90 if count < 8 else 60):
            return colours


def _word(rng: np.random.Generator) -> str:
    return str(rng.choice(WORDS))


def _label(paper: Paper, x: float, y: float, ink: Any, name: int = -1) -> None:
    paper.text(_word(paper.rng), x, y, paper.rng.uniform(15, 26), ink, name)


def _ink(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(0, 70, 3) if rng.random() < 0.5 else np.full(3, rng.integers(0, 90))


def _map(paper: Paper) -> None:
    rng, w, h = paper.rng, paper.width, paper.height
    outlined, ink = paper.half == "chosen", _ink(rng)
    seeds = rng.uniform(0.18, 0.82, (int(rng.integers(4, 8)), 2)) * (w, h)
    colours, width = _palette(rng, len(seeds)), rng.uniform(1.5, 4)
    div = cv2.Subdiv2D((0, 0, w, h))
    div.insert([tuple(map(float, seed)) for seed in seeds])
    edge = 0.08 * min(w, h)
    for facet, colour in zip(div.getVoronoiFacetList([])[0], colours, strict=False):
        country = np.clip(np.asarray(facet), edge, (w - edge, h - edge))
        if cv2.contourArea(country.astype(np.float32)) < 2500:
            continue
        paper.area(country, colour)
        if outlined:
            paper.line(country, width, ink, closed=True)
        if (middle := country.mean(axis=0)) is not None and rng.random() < 0.8:
            _label(paper, middle[0] - 30, middle[1] - 10, ink, paper.last)


def _cell(paper: Paper) -> None:
    rng, w, h = paper.rng, paper.width, paper.height
    outlined, ink, colours = paper.half == "chosen", _ink(rng), _palette(rng, 6)
    width = rng.uniform(2, 5)
    r = 0.36 * min(w, h)
    for n, (x, y, radius) in enumerate(
        [(0, 0, r), (-0.35 * r, -0.2 * r, 0.33 * r), (0.4 * r, -0.35 * r, 0.17 * r), (0.3 * r, 0.4 * r, 0.24 * r),
         (-0.3 * r, 0.5 * r, 0.12 * r)]
    ):  # fmt: skip
        shape = _blob(rng, w / 2 + x, h / 2 + y, radius)
        paper.area(shape, colours[n])
        if outlined:
            paper.line(shape, width, ink, closed=True)
        if n:
            side = -1 if x < 0 else 1
            out = np.array([w / 2 + side * (r + 0.08 * w), h / 2 + y])
            paper.line(np.array([[w / 2 + x, h / 2 + y], out]), rng.uniform(1.2, 2.5), ink)
            _label(paper, out[0] + (6 if side > 0 else -80), out[1] - 10, ink, paper.last)


def _bars(paper: Paper) -> None:
    rng, w, h, ink = paper.rng, paper.width, paper.height, _ink(paper.rng)
    count = int(rng.integers(3, 8))
    colours = _palette(rng, count) if rng.random() < 0.5 else np.repeat(_palette(rng, 1), count, axis=0)
    left, top, right, bottom = 0.14 * w, 0.1 * h, 0.95 * w, 0.88 * h
    step = (right - left) / count
    if rng.random() < 0.5:
        for y in np.linspace(top, bottom, 5)[:-1]:
            paper.line(np.array([(left, y), (right, y)]), 1.2, (190, 190, 190))
    for n, colour in enumerate(colours):
        high = rng.uniform(0.2, 0.95) * (bottom - top)
        paper.area(_box(left + (n + 0.2) * step, bottom - high, 0.6 * step, high), colour)
        _label(paper, left + (n + 0.2) * step, bottom + 8, ink, paper.last)
    paper.line(np.array([(left, top), (left, bottom), (right, bottom)]), rng.uniform(1.5, 3), ink)
    for y in np.linspace(top, bottom, 5):
        paper.line(np.array([(left - 8, y), (left, y)]), 1.5, ink)
        paper.text(str(int(rng.integers(10, 99))), left - 44, y - 10, 17, ink)


def _pie(paper: Paper) -> None:
    rng, w, h, ink = paper.rng, paper.width, paper.height, _ink(paper.rng)
    shares = rng.dirichlet(np.full(int(rng.integers(3, 7)), 4.0))
    turns, r = 2 * np.pi * np.concatenate([[0], np.cumsum(shares)]), 0.34 * min(w, h)
    for colour, one, other in zip(_palette(rng, len(shares)), turns, turns[1:], strict=False):
        turn = np.linspace(one, other, 60)
        middle = (one + other) / 2
        rim = np.stack([w / 2 + r * np.cos(turn), h / 2 + r * np.sin(turn)], axis=1)
        paper.area(np.concatenate([[(w / 2, h / 2)], rim]), colour)
        _label(paper, w / 2 + 1.2 * r * np.cos(middle) - 20, h / 2 + 1.2 * r * np.sin(middle) - 8, ink, paper.last)


def _scene(paper: Paper) -> None:
    rng, w, h, colours = paper.rng, paper.width, paper.height, _palette(paper.rng, 8)
    sky = 0.62 * h
    paper.area(_box(0, 0, w, sky), colours[0])
    paper.area(_box(0, sky, w, h - sky), colours[1])
    for n in range(2, 7):
        x, y, size = rng.uniform(0.15, 0.85) * w, rng.uniform(0.2, 0.85) * h, rng.uniform(0.06, 0.15) * min(w, h)
        paper.area(_blob(rng, x, y, size, 0.2) if n % 2 else _box(x - size, y - size, 2 * size, 1.6 * size), colours[n])


def _tiles(paper: Paper) -> None:
    rng, w, h = paper.rng, paper.width, paper.height
    colours = _palette(rng, 6)
    for n in range(int(rng.integers(4, 10))):
        x, y, size = rng.uniform(0.12, 0.88) * w, rng.uniform(0.12, 0.88) * h, rng.uniform(0.05, 0.17) * min(w, h)
        shape = _blob(rng, x, y, size, 0.3) if rng.random() < 0.5 else _box(x - size, y - size, 2 * size, size)
        paper.area(shape, colours[n % 6])


def _house(paper: Paper) -> None:
    rng, w, h, ink, width = paper.rng, paper.width, paper.height, _ink(paper.rng), paper.rng.uniform(1.5, 6)
    x, y, a, b = 0.3 * w, 0.45 * h, 0.35 * w, 0.35 * h
    paper.line(_box(x, y, a, b), width, ink, closed=True)
    paper.line(np.array([(x - 10, y), (x + a / 2, y - 0.25 * h), (x + a + 10, y)]), width, ink)
    paper.line(_box(x + 0.4 * a, y + 0.45 * b, 0.2 * a, 0.55 * b), width, ink, closed=True)
    for n in (0.1, 0.7):
        paper.line(_box(x + n * a, y + 0.2 * b, 0.18 * a, 0.2 * b), width, ink, closed=True)
        paper.line(np.array([(x + (n + 0.09) * a, y + 0.2 * b), (x + (n + 0.09) * a, y + 0.4 * b)]), width, ink)
    sun = np.array([0.85 * w, 0.15 * h])
    paper.line(_blob(rng, *sun, 0.07 * h, 0), width, ink, closed=True)
    for turn in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        way = np.array([np.cos(turn), np.sin(turn)])
        paper.line(np.array([sun + 0.09 * h * way, sun + 0.13 * h * way]), width, ink)
    paper.line(np.array([(0.03 * w, y + b), (0.97 * w, y + b)]), width, ink)
    paper.line(_blob(rng, 0.14 * w, 0.5 * h, 0.09 * h), width, ink, closed=True)


def _outlines(paper: Paper) -> None:
    rng, w, h, ink, width = paper.rng, paper.width, paper.height, _ink(paper.rng), paper.rng.uniform(1.3, 5)
    for x in np.linspace(0.2, 0.8, int(rng.integers(2, 4))):
        for y in np.linspace(0.25, 0.75, int(rng.integers(1, 3))):
            paper.line(_blob(rng, x * w, y * h, rng.uniform(0.06, 0.14) * min(w, h), 0.3), width, ink, closed=True)
            if rng.random() < 0.4:
                _label(paper, x * w - 20, y * h - 8, ink)


def _flowers(paper: Paper) -> None:
    rng, w, h, ink, width = paper.rng, paper.width, paper.height, _ink(paper.rng), paper.rng.uniform(1.5, 5)
    for _ in range(int(rng.integers(1, 4))):
        x, y, r = rng.uniform(0.2, 0.8) * w, rng.uniform(0.2, 0.5) * h, rng.uniform(0.05, 0.1) * min(w, h)
        paper.line(_blob(rng, x, y, r, 0), width, ink, closed=True)
        for turn in np.linspace(0, 2 * np.pi, 7, endpoint=False):
            at = x + 1.9 * r * np.cos(turn), y + 1.9 * r * np.sin(turn)
            paper.line(_blob(rng, *at, 0.72 * r, 0.1), width, ink, closed=True)
        rows = np.linspace(y + 2.8 * r, 0.95 * h, 30)
        paper.line(np.stack([x + 12 * np.sin(rows / 40), rows], axis=1), width, ink)


def _plan(paper: Paper) -> None:
    rng, w, h, ink, width = paper.rng, paper.width, paper.height, _ink(paper.rng), paper.rng.uniform(2, 6)
    paper.line(_box(0.1 * w, 0.1 * h, 0.8 * w, 0.8 * h), width, ink, closed=True)
    for n in range(int(rng.integers(2, 5))):
        x, y = rng.uniform(0.2, 0.8) * w, rng.uniform(0.2, 0.8) * h
        wall = [(x, 0.1 * h), (x, y)] if n % 2 else [(0.1 * w, y), (x, y)]
        paper.line(np.array(wall), width, ink)
    for _ in range(int(rng.integers(0, 4))):
        _label(paper, rng.uniform(0.15, 0.7) * w, rng.uniform(0.15, 0.8) * h, ink)


def _sketch(paper: Paper) -> None:
    rng, w, h, ink, width = paper.rng, paper.width, paper.height, _ink(paper.rng), paper.rng.uniform(1.5, 4)
    for _ in range(int(rng.integers(3, 8))):
        n = int(rng.integers(4, 9))
        at = np.stack([np.linspace(0.1, 0.9, n) * w, (rng.uniform(0.2, 0.8) + rng.normal(0, 0.06, n)) * h], axis=1)
        fine = np.linspace(0, n - 1, 60)
        paper.line(np.stack([np.interp(fine, np.arange(n), at[:, k]) for k in (0, 1)], axis=1), width, ink)


def _geometry(paper: Paper) -> None:
    rng, w, h, ink, width = paper.rng, paper.width, paper.height, _ink(paper.rng), paper.rng.uniform(1.3, 3.5)
    corners = np.array([(0.15, 0.85), (0.85, 0.8), (0.45, 0.15)]) * (w, h) + rng.uniform(-20, 20, (3, 2))
    paper.line(corners, width, ink, closed=True)
    paper.line(np.array([corners[2], (corners[0] + corners[1]) / 2]), width, ink)
    paper.line(_blob(rng, *corners.mean(axis=0), 0.15 * min(w, h), 0), width, ink, closed=True)
    for corner, letter in zip(corners, "ABC", strict=True):
        paper.text(letter + " " + _word(rng), corner[0] - 30, corner[1] + (8 if corner[1] > h / 2 else -34), 22, ink)


def _dashed(paper: Paper) -> None:
    rng, w, h, ink, ways = paper.rng, paper.width, paper.height, _ink(paper.rng), list[np.ndarray]()
    _outlines(paper)  # solid lines and labels, which the others cross
    for x in np.arange(0.03 * w, 0.3 * w, rng.uniform(9, 16)):  # a hatched and a stippled corner
        paper.line(np.array([(x, 0.97 * h), (x + 0.06 * h, 0.9 * h)]), 1.5, ink)
        for spot in rng.uniform((0.7 * w, 0.9 * h), (0.97 * w, 0.98 * h), (9, 2)):
            paper.line(spot[None].repeat(2, axis=0), 2.5, ink)
    for n in range(4):
        width, turn, start = rng.uniform(1.5, 4), np.linspace(0, 2 * np.pi, 120), 0.0
        at = np.stack([w * (0.08 + 0.13 * turn), h * (0.2 * (n + 1) + 0.06 * np.sin(rng.uniform(1, 3) * turn))], 1)
        if paper.half == "told":
            ring = _blob(rng, w / 2, h / 2, (0.15 + 0.1 * n) * min(w, h), 0.05)
            at = ring if n % 2 else rng.uniform(0.06, 0.94, (2, 2)) * (w, h)
        way, gap = shapely.LineString(at), rng.uniform(2.2, 4) * width
        for dash in cycle([rng.choice([0, 2, 4, 6]) * width, *[0.0] * (rng.random() < 0.25)]):
            if start + dash > way.length:
                break
            paper.line(shapely.get_coordinates(substring(way, start, start + dash)).repeat(2, axis=0), width, ink)
            start += dash + gap
        ways.append(at)
    paper.made.lines[:] = ways


def _page(columns: int) -> Callable[[Paper], None]:
    def draw(paper: Paper) -> None:
        rng, ink, size = paper.rng, _ink(paper.rng), paper.rng.uniform(13, 24)
        wide = 0.88 * paper.width / columns
        for column in range(columns):
            left, y = 0.06 * paper.width + column * (wide + 8), 0.07 * paper.height
            if rng.random() < 0.5:
                paper.text(f"{_word(rng)} {_word(rng)}", left, y, 1.6 * size, ink)
                y += 2.6 * size
            while y < 0.92 * paper.height:
                line, room = "", wide * rng.uniform(0.5 if rng.random() < 0.15 else 0.9, 0.95)
                while len(line) * 0.55 * size < room:
                    line += " " * bool(line) + _word(rng)
                paper.text(line[: int(room / (0.6 * size))], left, y, size, ink)
                y += size * (2.4 if rng.random() < 0.1 else 1.4)

    return draw


# What is drawn, by half and kind; maps and cells have outlines in the first half only.
FAMILIES: dict[str, dict[str, tuple[Callable[[Paper], None], ...]]] = {
    "chosen": {"lines": (_house, _flowers, _sketch), "drawing": (_map, _cell, _bars, _scene), "text": (_page(1),)},
    "told": {"lines": (_outlines, _plan, _geometry), "drawing": (_map, _cell, _pie, _tiles), "text": (_page(2),)},
}


def _noise(sigma: float) -> Callable[..., np.ndarray]:
    return lambda picture, rng: np.clip(picture + rng.normal(0, sigma, picture.shape), 0, 255).astype(np.uint8)


def _jpeg(quality: int) -> Callable[..., np.ndarray]:
    def copy(picture: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        return cv2.imdecode(cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])[1], cv2.IMREAD_COLOR)

    return copy


def _shadow(depth: float) -> Callable[..., np.ndarray]:
    def copy(picture: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        small = cv2.resize(rng.random((4, 4)).astype(np.float32), picture.shape[1::-1], interpolation=cv2.INTER_CUBIC)
        return (picture * (1 - depth * np.clip(small, 0, 1))[..., None]).astype(np.uint8)

    return copy


def _both(*copies: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
    def copy(picture: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        for each in copies:
            picture = each(picture, rng)
        return picture

    return copy


_BLUR, _TINT = (
    lambda picture, rng: cv2.GaussianBlur(picture, (0, 0), 0.8),
    lambda picture, rng: (picture * np.array([0.86, 0.95, 0.97])).astype(np.uint8),
)
COPIES = {
    "chosen": {"clean": _both(), "jpeg 75": _jpeg(75), "noise 4": _noise(4), "photo": _both(_shadow(0.45), _noise(3))},
    "told": {"jpeg 50": _jpeg(50), "noise 7": _noise(7), "tint": _TINT, "scan": _both(_BLUR, _shadow(0.35), _jpeg(80))},
}
"""How a drawing becomes a file, by half."""


def tilted(made: Made, degrees: float) -> Made:
    """Return the drawing turned, with its truth."""
    rows, columns = made.labels.shape
    turn = cv2.getRotationMatrix2D(((columns - 1) / 2, (rows - 1) / 2), degrees, 0.94)
    paper = tuple(int(each) for each in made.picture[2, 2])
    picture = cv2.warpAffine(made.picture, turn, (columns, rows), flags=cv2.INTER_CUBIC, borderValue=paper)
    labels = cv2.warpAffine(
        made.labels.astype(np.float32),
        turn,
        (columns, rows),
        flags=cv2.INTER_NEAREST,
        borderValue=int(made.labels[2, 2]),
    )

    def move(at: np.ndarray) -> np.ndarray:
        return at @ turn[:, :2].T + turn[:, 2]

    corners = [move(np.array([(a, b), (c, b), (c, d), (a, d)])) for a, b, c, d in made.texts]
    texts = [(*corner.min(axis=0), *corner.max(axis=0)) for corner in corners]
    lines = [move(line) for line in made.lines]
    return replace(made, picture=picture, labels=labels.astype(np.int32), lines=lines, texts=texts)


def made_drawings(half: str, kind: str, count: int, seed: int = 0) -> Iterator[Made]:
    """Yield drawings of a kind from the styles of a half."""
    families, copies = (_dashed,) if kind == "dashed" else FAMILIES[half][kind], list(COPIES[half].items())
    for number in range(count):
        rng = np.random.default_rng([seed, number, len(half), *map(ord, kind)])
        draw, (name, copy) = families[number % len(families)], copies[number // len(families) % len(copies)]
        paper = Paper(rng, half)
        draw(paper)
        made = paper.finished(kind, f"{draw.__name__.strip('_')}, {name}")
        if rng.random() < 0.3:
            made = tilted(made, rng.uniform(-4, 4))
        yield replace(made, picture=copy(made.picture, rng))
