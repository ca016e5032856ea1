"""A page to send: its surface in whole steps, data as JSON, and HTML with a policy that asks nobody."""

import io
import json
import zlib
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

import numpy as np
from jaxtyping import Float32, Int32, Shaped, UInt16
from PIL import Image

from tangible_core.data import HapticSurface, Material, Relief, Work, digest_of, to_rgb8
from tangible_core.scene import middle_pixels, reduced_map, reduced_shape
from tangible_legibility.words.languages import LANGUAGES, Language, Words, one_line
from tangible_render.surface.coefficients import spline_coefficients
from tangible_render.surface.dequantise import dequantise
from tangible_report.description import describe, facts
from tangible_report.description.at_length import tell
from tangible_web.materials import distinct_materials, surface_facts

# The most cells: software draws them in a fraction of a second, and the page is one for old phones too.
MAX_CELLS = 400_000
# Steps of heights: half of one is what a height is off by. Fingers feel no height below 10 um on a smooth surface.
STEPS_M = (1e-6, 2e-6, 4e-6)
COARSER = 1.25  # the factor from one size of cells to the next
MAX_COARSER = 12


@dataclass(frozen=True)
class SentSurface:
    """A surface in whole steps of height."""

    numbers: UInt16[np.ndarray, "h4 w4"]  # coefficients of the spline: `low_m` plus this number of steps
    low_m: float
    step_m: float
    labels: Int32[np.ndarray, "h w"] | None
    extent_m: tuple[float, float]

    @property
    def coefficients(self) -> Float32[np.ndarray, "h4 w4"]:
        """The coefficients in metres, the same bits as in the page."""
        return (self.low_m + self.step_m * self.numbers.astype(np.float64)).astype(np.float32)

    @property
    def height_m(self) -> Float32[np.ndarray, "h w"]:
        """The heights at the cells' centres."""
        whole = self.coefficients.astype(np.float64)
        lines = (whole[1:-3] + 4 * whole[2:-2] + whole[3:-1]) / 6
        return ((lines[:, 1:-3] + 4 * lines[:, 2:-2] + lines[:, 3:-1]) / 6).astype(np.float32)


def surface_to_send(work: Work) -> Iterator[SentSurface]:
    """Yield the surface in finer and coarser forms, the finest first."""
    surface = work.surface
    first = max(1.0, (surface.height_m.size / MAX_CELLS) ** 0.5)
    for coarser in range(MAX_COARSER):
        small = _reduce(surface, first * COARSER**coarser)
        for step_m in STEPS_M:
            yield _quantise(small, step_m)


def fits(work: Work, spline: SentSurface) -> str:
    """Return a sentence on what was made coarser for the page; empty if nothing was."""
    rows, columns = (side - 4 for side in spline.numbers.shape)
    wide, cells = work.surface.height_m.shape[1], f"{columns} x {rows} cells"
    coarse = f"the surface has {cells}, of {wide} x {work.surface.height_m.shape[0]}" if columns < wide else ""
    steps = f"heights are in steps of {1e6 * spline.step_m:.3g} um" if spline.step_m > 1.01 * STEPS_M[0] else ""
    return "; ".join(filter(None, (coarse, steps)))


def _reduce(surface: HapticSurface, factor: float) -> HapticSurface:
    shape = reduced_shape(surface.height_m.shape, factor)
    if shape == surface.height_m.shape:
        return surface
    relief = Relief(reduced_map(surface.height_m, shape), surface.extent_m)
    labels = None if surface.labels is None else np.ascontiguousarray(middle_pixels(surface.labels, shape))
    return replace(surface, relief=relief, labels=labels)


def _quantise(surface: HapticSurface, step_m: float) -> SentSurface:
    coefficients = spline_coefficients(dequantise(surface.height_m)).astype(np.float64)
    low_m = float(coefficients.min())
    step_m = max(step_m, float(np.ptp(coefficients)) / (2**16 - 1))
    numbers = np.rint((coefficients - low_m) / step_m).astype(np.uint16)
    return SentSurface(numbers, low_m, step_m, surface.labels, surface.extent_m)


# The longest side of the picture: more than a phone shows, and opened a quarter sooner in software than 2048.
MAX_SIDE_PX = 1600
# The room that is left for a picture at least, bytes: the surface is made coarser for it.
MIN_PHOTO = 200_000
QUALITIES = (88, 80, 70, 60)
SMALLER = 0.8
PLAIN = Material("", 800.0, 0.0, 0.0, 0.0)  # values that `proxy` takes for a surface without materials


def pack(spline: SentSurface, work: Work) -> dict[str, Any]:
    """Return the data of the page, without the picture."""
    surface = _surface_in_words(spline, work)
    materials, kinds = distinct_materials(surface.materials or ())
    digest = digest_of((spline.numbers, spline.labels, work.title, work.names))
    return {
        "meta": _meta(spline, surface, work, materials, digest),
        "low_m": spline.low_m,
        "step_m": spline.step_m,
        "heights": deflate(spline.numbers),
        "labels": "" if spline.labels is None else deflate(spline.labels),
        "kinds": kinds.tolist(),
        "rows": _rows(work.surface.materials if spline.labels is not None else None),
        "photo": "",
        **_words(surface, work),
    }


def as_json(data: Mapping[str, Any]) -> str:
    """Return JSON that may stand in a script of HTML, whatever its texts contain: plain letters, and no `<`."""
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def deflate(numbers: Shaped[np.ndarray, "h w"]) -> str:
    """Return whole numbers of 16 bits as differences to the plane through three neighbours, deflated, in base64."""
    values = np.pad(numbers.astype(np.int64), ((1, 0), (1, 0)))
    plane = values[:-1, 1:] + values[1:, :-1] - values[:-1, :-1]
    difference = (values[1:, 1:] - plane).astype(np.uint16).astype(np.int16).astype(np.int32)
    zigzag = ((difference << 1) ^ (difference >> 31)).astype(np.uint16).ravel()
    low, high = (zigzag & 255).astype(np.uint8), (zigzag >> 8).astype(np.uint8)
    return b64encode(zlib.compress(low.tobytes() + high.tobytes(), 9)).decode()


def _surface_in_words(spline: SentSurface, work: Work) -> HapticSurface:
    """Return the surface that is described: with the materials of the work where the force law has none."""
    relief = Relief(np.maximum(spline.height_m, np.float32(0)), spline.extent_m)
    materials = work.surface.materials
    if materials is None and work.materials is not None:
        materials = work.materials.materials
    if spline.labels is None or materials is None or int(spline.labels.max()) >= len(materials):
        materials = work.surface.materials
    return HapticSurface(relief, spline.labels, materials, work.surface.names)


def _rows(materials: Sequence[Material] | None) -> list[tuple[float, float, float, float]]:
    """Return stiffness, damping and frictions of each label, as `proxy` has them; one row if all are alike."""
    rows = [
        (material.stiffness_n_per_m, material.damping_n_s_per_m, material.static_friction, material.dynamic_friction)
        for material in materials or (PLAIN,)
    ]
    return rows[:1] if len(set(rows)) == 1 else rows


def _meta(
    spline: SentSurface, surface: HapticSurface, work: Work, materials: Sequence[Material], digest: str
) -> dict[str, Any]:
    plain = [{**asdict(material), "name": one_line(material.name)} for material in materials]
    parts = None if surface.names is None else [one_line(name) for name in surface.names]
    heights, title = surface.height_m, one_line(work.title)
    has_photo = work.picture is not None
    return surface_facts(digest, title, heights, spline.extent_m, spline.labels, plain, parts=parts, photo=has_photo)


def _words(surface: HapticSurface, work: Work) -> dict[str, Any]:
    return {
        "describes": {language: description(surface, work, language) for language in LANGUAGES},
        "says": {language: describe(surface, one_line(work.title), language) for language in LANGUAGES},
    }


def description(surface: HapticSurface, work: Work, language: Language) -> dict[str, Any]:
    """Return the long description as texts."""
    kind = None if work.picture is not None else "heights"
    texts = tell(surface, work.title, language, facts(surface), kind)
    return {
        "overview": " ".join((*texts.overview, *[Words(language)("first frame")] * work.film)),
        "heading": texts.heading,
        "parts": [[part.label, " ".join(part.sentences)] for part in texts.parts],
        "left_out": texts.left_out,
    }


def photo(picture: np.ndarray, most_bytes: int) -> str:
    """Return a JPEG in base64, as large and as good as fits into this number of bytes of base64."""
    image = Image.fromarray(to_rgb8(picture))
    share = min(1.0, MAX_SIDE_PX / max(image.size))
    while True:
        size = tuple(max(1, round(share * side)) for side in image.size)
        small = image.resize((size[0], size[1]), Image.Resampling.BOX, reducing_gap=2.0)
        for quality in QUALITIES:
            jpeg = io.BytesIO()
            small.save(jpeg, "JPEG", quality=quality, optimize=True)
            if 4 * -(-jpeg.tell() // 3) <= most_bytes or max(size) <= 16:
                return b64encode(jpeg.getvalue()).decode()
        share *= SMALLER


def make_page(
    title: str, language: Language, named_in: str, data: Mapping[str, Any], script: str, style: str, licences: str
) -> str:
    """Return the page. language: of its words; named_in: the tag of the language of title and names."""
    if "</script" in script.lower() or "</style" in style.lower():
        raise ValueError("script and style must not end their elements")
    name, say = escape(one_line(title)), Words(language)
    texts = data.get("describes", {}).get(language)
    return Template(files("tangible_send").joinpath("page.html").read_text(encoding="utf-8")).substitute(
        language=language,
        policy=_policy(script, style),
        title=name or say("untitled"),
        style=style,
        named_in=escape(named_in) if name else language,
        no_script=say("no script"),
        description=_describe(texts) if texts else "",
        licences=licences.replace("--", "- -"),
        data=as_json(data),
        script=script,
    )


def _policy(script: str, style: str) -> str:
    """Return the policy: only this script and this style, and no connection at all."""
    scripts, styles = (b64encode(sha256(text.encode()).digest()).decode() for text in (script, style))
    rules = {
        "default-src": "'none'",
        "script-src": f"'sha256-{scripts}'",
        "style-src": f"'sha256-{styles}'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    return "; ".join(map(" ".join, rules.items()))


def _describe(texts: Mapping[str, Any]) -> str:
    items = "".join(f"<li><bdi>{escape(label)}</bdi>. {escape(says)}</li>\n" for label, says in texts["parts"])
    part_list = f"<h2>{escape(texts['heading'])}</h2>\n<ul>\n{items}</ul>" if items else ""
    remark = f"<p>{escape(texts['left_out'])}</p>" if texts["left_out"] else ""
    return f"<p>{escape(texts['overview'])}</p>\n{part_list}{remark}"
