"""The panels of segments, with the names of their materials, and of parts, with their own names."""

import numpy as np
from jaxtyping import Float, Int
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from tangible_core.data import (
    HapticSurface,
    MaterialMap,
    PartMap,
    SegmentMap,
    Views,
    border_pixels,
    name_part,
    shown_number,
    to_grey,
)
from tangible_legibility.cells import largest_disc

from ..style import INK, bare, colours, inches, thin_out

TINT = 0.45  # the share of a region's colour; the rest is the picture
# The longer side of the drawn picture, about; small pictures grow, so that outlines stay thin.
SIDE_PX = 800
NAMED = 40  # the number of segments, the largest, that may carry their name
# The height of a line of the legend, inches; the legend is as high as the panel.
LINE_IN = 0.165
SHORT, NUMBERS = 14, 3
"""The most letters of a name, and the most numbers of segments, in an entry of the legend."""


def draw_segments(
    axes: Axes, segments: SegmentMap, views: Views | None = None, materials: MaterialMap | None = None
) -> str:
    """Draw regions tinted by material (or by segment), outlined, numbered, and named if there is room."""
    names = [name_part(label, noun="segment") for label in range(segments.count)]
    if materials is not None:
        names = [material.name for material in materials.materials]
    kinds = {name: kind for kind, name in enumerate(dict.fromkeys(names))}
    labels = _drawn_size(segments.labels)
    kind_of = np.array([kinds[name] for name in names])[labels]
    grey = np.ones(labels.shape, np.float32) if views is None else _grey(views.left, segments.labels.shape)
    _draw_regions(axes, grey, labels, kind_of)
    _write_names(
        axes, labels, [f"{shown_number(label)} {name}" for label, name in enumerate(names)] if materials else names
    )
    shares = np.bincount(kind_of.ravel(), minlength=len(kinds)) / kind_of.size
    _draw_legend(axes, _entries(names) if materials else [*kinds], shares)
    materials_too = f", {_count(len(kinds), 'material')}" if materials else ""
    bare(axes, _count(segments.count, "segment") + materials_too)
    return "Segments and their materials" if materials else "Segments"


def draw_parts(axes: Axes, parts: PartMap, views: Views | None = None, surface: HapticSurface | None = None) -> str:
    """Draw parts, each in its own colour, outlined, numbered, and named if there is room."""
    names = [""] * parts.count if surface is None or surface.names is None else surface.names
    titles = [f"{shown_number(number)} {name}".rstrip() for number, name in enumerate(names)]
    labels = _drawn_size(parts.labels)
    grey = np.ones(labels.shape, np.float32) if views is None else _grey(views.left, parts.labels.shape)
    order = _near_to_far(parts, surface)
    rank = np.empty(parts.count, np.intp)
    rank[order] = np.arange(parts.count)
    _draw_regions(axes, grey, labels, rank[labels])
    _write_names(axes, labels, titles)
    materials = None if surface is None else surface.materials
    entries = [_short(titles[number]) + (f": {materials[number].name}" if materials else "") for number in order]
    shares = np.bincount(parts.labels.ravel(), minlength=parts.count) / parts.labels.size
    _draw_legend(axes, entries, shares[order])
    bare(axes, _count(parts.count, "part"))
    return "Parts, from near to far" if surface else "Parts"


def _near_to_far(parts: PartMap, surface: HapticSurface | None) -> list[int]:
    """Return the numbers of parts by their heights, the highest first; in their order if there is no surface."""
    if surface is None or surface.labels is None:
        return list(range(parts.count))
    sums = np.bincount(surface.labels.ravel(), surface.height_m.ravel(), parts.count)
    counts = np.bincount(surface.labels.ravel(), minlength=parts.count)
    return np.argsort(-(sums / np.maximum(counts, 1)), kind="stable").tolist()


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def _grey(picture: np.ndarray, shape: tuple[int, ...]) -> Float[np.ndarray, "h w"]:
    """Return the picture in grey under segments of (h, w), which may be coarser, at the drawn size."""
    rows, columns = (np.arange(new) * old // new for new, old in zip(shape, picture.shape, strict=False))
    return to_grey(_drawn_size(picture if picture.shape[:2] == shape else picture[np.ix_(rows, columns)]))


def _drawn_size(map_: np.ndarray) -> np.ndarray:
    times = max(1, SIDE_PX // max(map_.shape[:2]))
    return np.repeat(np.repeat(thin_out(map_, SIDE_PX), times, axis=0), times, axis=1)


def _draw_regions(
    axes: Axes, grey: Float[np.ndarray, "h w"], labels: Int[np.ndarray, "h w"], kind_of: Int[np.ndarray, "h w"]
) -> None:
    picture = (1 - TINT) * grey[..., None] + TINT * colours(int(kind_of.max()) + 1)[kind_of]
    picture[border_pixels(labels)] *= 0.2
    axes.imshow(picture, interpolation="antialiased")


def _write_names(axes: Axes, labels: Int[np.ndarray, "h w"], names: list[str]) -> None:
    """Write names, or numbers where only those fit, each in the middle of the largest disc in its segment."""
    point_px = inches(axes)[0] / 72 * labels.shape[1]
    for label in np.argsort(-np.bincount(labels.ravel()), kind="stable")[:NAMED].tolist():
        if (disc := largest_disc(labels == label)) is None:
            continue
        for text in (names[label], str(shown_number(label))):
            if 2 * disc.radius_px > point_px * max(10.0, 4.2 * len(text)):
                halo = withStroke(linewidth=2, foreground="white")
                axes.text(disc.column, disc.row, text, fontsize=8, ha="center", va="center", path_effects=[halo])
                break


def _short(name: str) -> str:
    return name if len(name) <= SHORT else f"{name[: SHORT - 3]}..."


def _entries(names: list[str]) -> list[str]:
    """Return the entries of the legend: each material after the numbers of its segments."""
    labels: dict[str, list[str]] = {}
    for label, name in enumerate(names):
        labels.setdefault(name, []).append(str(shown_number(label)))
    more = {name: ", ..." if len(numbers) > NUMBERS else "" for name, numbers in labels.items()}
    return [f"{', '.join(numbers[:NUMBERS])}{more[name]}: {_short(name)}" for name, numbers in labels.items()]


def _draw_legend(axes: Axes, entries: list[str], shares: Float[np.ndarray, " n"]) -> None:
    """Draw the legend, with as many entries as there is room for."""
    lines = max(2, int(1 / (LINE_IN * inches(axes)[1])))
    fit = len(entries) if len(entries) <= lines else lines - 1
    keys = [
        Patch(facecolor=colour, edgecolor=INK, linewidth=0.6, label=f"{entry}, {100 * share:.0f} %")
        for entry, share, colour in zip(entries[:fit], shares, colours(fit), strict=False)
    ]
    if len(entries) > fit:
        keys.append(Patch(alpha=0, label=f"and {len(entries) - fit} more"))
    axes.legend(
        handles=keys, loc="upper left", bbox_to_anchor=(1.0, 1.0), handlelength=1, handleheight=1,
        borderaxespad=0.0, borderpad=0.5, labelspacing=0.35,
    )  # fmt: skip
