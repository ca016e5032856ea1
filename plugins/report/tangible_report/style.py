"""The style of every panel: type, colours, colour bars; legible with colour blindness and in grey print."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap, to_rgb

INK = "#222222"
PALE = "#e9e9e9"
STYLE = Path(__file__).with_name("report.mplstyle")  # the style sheet of every panel, for `matplotlib.style`

OKABE_ITO = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#999999")
"""Eight colours that colour-blind readers tell apart, from Okabe & Ito, Color Universal Design (2008), reordered."""
# The colours of disparities and heights: perceptually uniform, monotonous in lightness.
VIRIDIS: Colormap = colormaps["viridis"]
ERRORS: Colormap = colormaps["magma_r"]  # the colours of errors: pale is right, dark is wrong
# The colours of forces: dark enough at the pale end for a white ground.
FORCES = ListedColormap(colormaps["magma_r"](np.linspace(0.3, 0.95, 256)), "forces")


def colours(count: int) -> Float64[np.ndarray, "n 3"]:
    """Return n colours, no two alike: those of Okabe & Ito; beyond 24, quasirandom (Roberts 2018)."""
    plain = np.array([to_rgb(colour) for colour in OKABE_ITO])
    first = np.vstack([plain, 0.5 * plain, 0.45 * plain + 0.55])
    step = 1 / 1.2207440846057596 ** np.arange(1, 4)
    rest = 0.1 + 0.8 * ((0.5 + np.arange(1, max(count - len(first), 0) + 1)[:, None] * step) % 1)
    return np.vstack([first, rest])[:count]


def bare(axes: Axes, caption: str = "") -> None:
    """Remove the ticks and write a caption instead; let the picture fill its panel, which has the scene's shape."""
    axes.set(xticks=[], yticks=[], aspect="auto")
    axes.set_xlabel(caption, fontsize=8, labelpad=4, loc="left")


def hatch(axes: Axes) -> None:
    """Hatch the transparent areas, where nothing is known."""
    axes.patch.set(facecolor=PALE, hatch="//////", edgecolor="#aaaaaa")


def inches(axes: Axes) -> tuple[float, float]:
    """Return one inch as a share of the axes' width and height."""
    return axes.figure.dpi / axes.bbox.width, axes.figure.dpi / axes.bbox.height


def colour_bar(axes: Axes, mappable: Any, label: str, **options: Any) -> None:
    """Draw a colour bar of the axes' height, at a fixed distance in inches to their right."""
    figure = axes.figure
    inch = inches(axes)[0]
    bar = figure.colorbar(mappable, cax=axes.inset_axes((1 + 0.08 * inch, 0, 0.1 * inch, 1)), **options)
    bar.set_label(label)
    bar.outline.set_linewidth(0.6)


def thin_out(map_: np.ndarray, most: int = 1000) -> np.ndarray:
    """Return every n-th row and column, so that no side is longer than `most`: a sheet shows no more."""
    step = -(-max(map_.shape[:2]) // most)
    return map_[::step, ::step]
