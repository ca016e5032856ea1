"""The panels of segments and parts, with their names, of the input pictures, of disparity and of its error."""

import numpy as np
from jaxtyping import Float, Int
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from tangible_core.data import (
    DisparityMap,
    HapticSurface,
    MaterialMap,
    PartMap,
    SegmentMap,
    Views,
    border_pixels,
    name_part,
    shown_number,
    to_grey,
    to_rgb8,
)
from tangible_core.metrics import absolute_error, disparity_errors
from tangible_legibility.cells import largest_disc

from ..style import ERRORS, INK, VIRIDIS, bare, colour_bar, colours, hatch, inches, thin_out

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


def draw_views(axes: Axes, views: Views) -> str:
    """Draw the left view, with the right one small in its corner."""
    rows, columns = views.shape
    axes.imshow(to_rgb8(thin_out(views.left)), interpolation="antialiased")
    bare(axes, f"{columns} x {rows} px{_camera(views)}")
    if views.right is None:
        return "Input"
    corner = axes.inset_axes((0.64, 0.015, 0.35, 0.35), anchor="SE")
    corner.imshow(to_rgb8(thin_out(views.right, 400)), interpolation="antialiased")
    corner.set(xticks=[], yticks=[])
    corner.spines[:].set(color="white", linewidth=1.5)
    return "Input: left, inset right"


def _camera(views: Views) -> str:
    at = views.calibration
    if at is None:
        return ""
    baseline = f"{1000 * at.baseline_m:.4g} mm" if at.baseline_m < 1 else f"{at.baseline_m:.4g} m"
    return f", f {at.focal_px:.4g} px, B {baseline}"


CLIP_PX = 4.0  # the error at which colours are clipped, pixels
UNITS = {"px": ("Disparity", "disparity [px]"), "relative": ("Relative nearness", "nearness, 0 far to 1 near")}
"""Unit -> headline and label of the colour bar."""


def draw_disparity(axes: Axes, disparity: DisparityMap) -> str:
    """Draw the map from far (dark) to near (bright); unknown pixels are hatched."""
    values = disparity.disparity_px
    finite = values[np.isfinite(values)]
    low, high = np.percentile(finite, (0.5, 99.5)) if finite.size else (0.0, 1.0)
    hatch(axes)
    image = axes.imshow(np.ma.masked_invalid(thin_out(values)), cmap=VIRIDIS, vmin=low, vmax=high)
    headline, label = UNITS[disparity.unit]
    colour_bar(axes, image, label, extend="both")
    missing = 100 * (1 - finite.size / values.size)
    bare(axes, f"hatched: unknown, {missing:.1f} %" if missing else "known everywhere")
    return headline


def draw_disparity_error(axes: Axes, disparity: DisparityMap, truth: np.ndarray) -> str:
    """Draw the absolute error, clipped at CLIP_PX; pixels without estimate are hatched, pixels without truth white."""
    figures = disparity_errors(disparity.disparity_px, truth)
    error_px = thin_out(absolute_error(disparity.disparity_px, truth))
    hatch(axes)
    axes.imshow(np.ma.masked_where(np.isfinite(thin_out(truth)), np.ones(error_px.shape)), cmap="gray", vmin=0, vmax=1)
    image = axes.imshow(np.ma.masked_invalid(error_px), cmap=ERRORS, vmin=0, vmax=CLIP_PX)
    colour_bar(axes, image, f"|error| [px], clipped at {CLIP_PX:g}", extend="max", ticks=range(int(CLIP_PX) + 1))
    bare(axes, "hatched: no estimate (bad); white: no truth")
    return f"Error: bad1 {figures['bad1']:.1f} %, bad2 {figures['bad2']:.1f} %"
