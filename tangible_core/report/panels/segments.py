"""Segments over the picture, with the names of their materials."""
# pyright: reportUnknownMemberType=false
# (matplotlib leaves its keywords without types)

import numpy as np
from jaxtyping import Bool, Float, Int
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from ...data import MaterialMap, SegmentMap, Views
from ...data.pictures import to_grey
from ..style import INK, OKABE_ITO, bare, inches, thinned

PALETTE = np.array([to_rgb(colour) for colour in OKABE_ITO])
TINT = 0.45
SIDE_PX = 800
"""The longer side as it is drawn, about; small pictures grow, so that outlines stay thin."""
NAMED = 40
"""So many of the largest segments may carry their name."""
LEGEND, SHORT = 9, 16
"""Entries of the legend and letters of a name, at most."""


def draw_segments(
    axes: Axes, segments: SegmentMap, views: Views | None = None, materials: MaterialMap | None = None
) -> str:
    """Regions tinted by material (by segment where there are none), outlined, named inside where the name fits."""
    names = [f"segment {label}" for label in range(segments.count)]
    if materials is not None:
        names = [material.name for material in materials.materials]
    kinds = {name: kind for kind, name in enumerate(dict.fromkeys(names))}
    labels = _drawn_size(segments.labels)
    kind_of = np.array([kinds[name] for name in names])[labels]
    grey = np.ones(labels.shape, np.float32) if views is None else _grey(views.left, segments.labels.shape)
    _draw_regions(axes, grey, labels, kind_of)
    _write_names(axes, labels, names)
    _draw_legend(axes, list(kinds), np.bincount(kind_of.ravel(), minlength=len(kinds)) / kind_of.size)
    materials_too = f", {_count(len(kinds), 'material')}" if materials else ""
    bare(axes, _count(segments.count, "segment") + materials_too)
    return "Segments and their materials" if materials else "Segments"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def _grey(picture: np.ndarray, shape: tuple[int, ...]) -> Float[np.ndarray, "h w"]:
    """The picture beneath segments of (h, w), which may be coarser, as it is drawn."""
    rows, columns = (np.arange(new) * old // new for new, old in zip(shape, picture.shape, strict=False))
    return to_grey(_drawn_size(picture if picture.shape[:2] == shape else picture[np.ix_(rows, columns)]))


def _drawn_size(map_: np.ndarray) -> np.ndarray:
    times = max(1, SIDE_PX // max(map_.shape[:2]))
    return np.repeat(np.repeat(thinned(map_, SIDE_PX), times, axis=0), times, axis=1)


def _draw_regions(
    axes: Axes, grey: Float[np.ndarray, "h w"], labels: Int[np.ndarray, "h w"], kind_of: Int[np.ndarray, "h w"]
) -> None:
    picture = (1 - TINT) * grey[..., None] + TINT * PALETTE[kind_of % len(PALETTE)]
    picture[_borders(labels)] *= 0.2
    axes.imshow(picture, interpolation="antialiased")


def _borders(labels: Int[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Pixels that have a neighbour, right, left, above or below, of another label."""
    found = np.zeros(labels.shape, bool)
    beside, below = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    found[:, 1:] |= beside
    found[:, :-1] |= beside
    found[1:] |= below
    found[:-1] |= below
    return found


def _largest(values: np.ndarray, most: int) -> list[int]:
    """Indices of the largest values, the first of equals first."""
    return [int(index) for index in np.argsort(-values, kind="stable")[:most]]


def _write_names(axes: Axes, labels: Int[np.ndarray, "h w"], names: list[str]) -> None:
    """Write names, the largest segment's first, each in the middle of the largest disc in its segment, if it fits."""
    point_px = inches(axes)[0] / 72 * labels.shape[1]
    for label in _largest(np.bincount(labels.ravel()), NAMED):
        column, row, radius_px = _largest_disc(labels == label)
        if 2 * radius_px > point_px * max(10.0, 4.2 * len(names[label])):
            halo = withStroke(linewidth=2, foreground="white")
            axes.text(column, row, names[label], fontsize=8, ha="center", va="center", path_effects=[halo])


def _largest_disc(region: Bool[np.ndarray, "h w"]) -> tuple[float, float, float]:
    """Column, row and radius of the largest disc inside a region, the picture's border being outside."""
    import cv2

    depth = cv2.distanceTransform(np.pad(region, 1).astype(np.uint8), cv2.DIST_L2, 3)
    row, column = np.unravel_index(np.argmax(depth), depth.shape)
    return float(column) - 1, float(row) - 1, float(depth[row, column])


def _short(name: str) -> str:
    return name if len(name) <= SHORT else f"{name[: SHORT - 3]}..."


def _draw_legend(axes: Axes, kinds: list[str], shares: Float[np.ndarray, " n"]) -> None:
    keys = [
        Patch(
            facecolor=OKABE_ITO[kind % len(OKABE_ITO)], edgecolor=INK, linewidth=0.6,
            label=f"{_short(kinds[kind])}, {100 * shares[kind]:.0f} %",
        )
        for kind in _largest(shares, LEGEND)
    ]  # fmt: skip
    if len(kinds) > LEGEND:
        keys.append(Patch(alpha=0, label=f"and {len(kinds) - LEGEND} more"))
    axes.legend(handles=keys, loc="upper left", bbox_to_anchor=(1.0, 1.02), handlelength=1, handleheight=1)
