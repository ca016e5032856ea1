"""The four charts of docs/explanation/performance.md, drawn from benchmarks/results: `python -m benchmarks.charts`."""

import re
from pathlib import Path
from typing import Any

from .results import ROOT, newest, promises

CHARTS = ROOT / "docs/pictures/performance.svg"
OURS, OTHERS = "#0b6e4f", "#8a8a8a"
# Rows of the section on lateness: loops of one kind of rights, and their labels.
LOOPS = {
    "no rights: all compiled": "ours, compiled",
    "no rights: compiled tick, a device that Python asks": "ours, a device in Python",
    "a loop in C": "a loop in C",
}


def table_of(result: dict[str, Any], *columns: str) -> list[tuple[str, ...]]:
    """Return these columns of the section's first table that has them all."""
    for block in result["blocks"]:
        if set(columns) <= set(block.get("columns", ())):
            at = [block["columns"].index(name) for name in columns]
            return [tuple(row[i] for i in at) for row in block["rows"]]
    raise LookupError(f"{result['title']} has no table with {', '.join(columns)}; measure it again")


def draw_depth(axes: Any, result: dict[str, Any]) -> None:
    """Draw wrong pixels over time, both on average of the scenes."""
    for method, time, wrong in table_of(result, "method", "time / baseline", "bad2 %"):
        colour = OTHERS if method.startswith("opencv") else OURS
        axes.plot(float(time), float(wrong), "o", color=colour)
        axes.annotate(
            method,
            (float(time), float(wrong)),
            (4, 4 - 13 * (method == "opencv-3way")),
            textcoords="offset points",
            fontsize=7,
            color=colour,
        )
    axes.set(xscale="log", xlabel="time, multiple of OpenCV's 3WAY", ylabel="wrong by over 2 px, %", title="Depth")
    mark(axes, (0.5, 1, 2, 4, 8))


def draw_texture(axes: Any, result: dict[str, Any]) -> None:
    """Draw how well segments fit over time, on textures that nothing was tuned on."""
    figures = promises(result)
    _, gabor, _ = figures["`gabor`, 80 mosaics of the reported half"]
    _, fast, _ = figures["`gabor`, fast option, 80 mosaics of the reported half"]
    points = {
        "OpenCV's filters and k-means": (1.0, number(r"recipe: ([\d.]+)", gabor)),
        "gabor": (1 / number(r"1/([\d.]+)", gabor), number(r"ARI ([\d.]+)", gabor)),
        "gabor, effort: fast": (1 / number(r"1/([\d.]+)", fast), number(r"ARI ([\d.]+)", fast)),
    }
    for method, (time, ari) in points.items():
        colour = OTHERS if method.startswith("OpenCV") else OURS
        axes.plot(time, ari, "o", color=colour)
        side = "right" if time == 1 else "left"
        axes.annotate(method, (time, ari), (0, 6), textcoords="offset points", fontsize=7, color=colour, ha=side)
    axes.set(xscale="log", xlabel="time, multiple of OpenCV's", ylabel="adjusted Rand index", title="Texture")
    mark(axes, (0.1, 0.2, 0.5, 1))
    axes.margins(y=0.2)


def draw_lateness(axes: Any, result: dict[str, Any]) -> None:
    """Draw how late the ticks of a loop are, by percentile."""
    rows = {row[0]: row[1:] for row in table_of(result, "loop", "p50", "p99", "p99.9", "latest")}
    for name, label in LOOPS.items():
        late_us = [max(1.0, number(r"(\d+)", cell)) for cell in rows[name]]
        style = "--" if label == "a loop in C" else "-"
        axes.plot(["half", "99 %", "99.9 %", "all"], late_us, "o" + style, label=label, ms=4)
    axes.set(yscale="log", ylabel="at most late by, µs", title="The loop, ticks every 1000 µs")
    axes.legend(fontsize=7)


def draw_borders(axes: Any, result: dict[str, Any]) -> None:
    """Draw borders of depth that are felt, before the relief knew of borders and now, with standard errors."""
    figures = promises(result)
    for place, what in enumerate(("found", "true")):
        _, measured, _ = figures[f"{what}, mean of 4 pairs of photographs"]
        now, now_error, before, before_error = map(float, re.findall(r"[\d.]+", measured))
        axes.bar(place - 0.2, before, 0.36, yerr=before_error, color=OTHERS, label="before" if not place else None)
        axes.bar(place + 0.2, now, 0.36, yerr=now_error, color=OURS, label="now" if not place else None)
    labels = ["true borders\nthat are felt", "felt steps\nthat are true"]
    axes.set(xticks=[0, 1], xticklabels=labels, ylim=(0, 1), ylabel="share", title="Relief of a pair")
    axes.legend(fontsize=7)


def mark(axes: Any, times: tuple[float, ...]) -> None:
    """Mark these multiples on the axis of time, and no others."""
    axes.xaxis.minorticks_off()
    axes.set_xticks(times, [f"{time:g}" for time in times])


def number(pattern: str, text: str) -> float:
    """Return the number that a pattern finds in a text. Raises: LookupError if it finds none."""
    if (match := re.search(pattern, text)) is None:
        raise LookupError(f"{pattern} is not in {text!r}")
    return float(match[1])


def main(path: Path = CHARTS) -> None:
    """Draw the charts."""
    from matplotlib import pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "tangible", "svg.fonttype": "none", "font.size": 8})
    results = newest()
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.2), layout="constrained")
    for axis, (draw, section) in zip(
        axes,
        ((draw_depth, "depth"), (draw_texture, "texture"), (draw_lateness, "servo_late"), (draw_borders, "relief")),
        strict=True,
    ):
        draw(axis, results[section])
        axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, metadata={"Date": None})
    print(path)


if __name__ == "__main__":
    main()
