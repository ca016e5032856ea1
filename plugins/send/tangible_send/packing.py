"""A page to send: its data as JSON, arrays deflated, the picture a JPEG; and HTML with a policy that asks nobody."""

import io
import json
import zlib
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from hashlib import sha256
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

import numpy as np
from jaxtyping import Shaped
from PIL import Image

from tangible_core.data import HapticSurface, Material, Relief, Work, digest_of, to_rgb8
from tangible_legibility.words.languages import LANGUAGES, Language, Words, one_line
from tangible_report.description import describe, facts
from tangible_report.description.at_length import tell
from tangible_web.materials import distinct_materials

from .surface import SentSurface

MAX_SIDE_PX = 1600
"""The longest side of the picture: more than a phone shows, and opened a quarter sooner in software than 2048."""
MIN_PHOTO = 200_000
"""The room that is left for a picture at least, bytes: the surface is made coarser for it."""
QUALITIES = (88, 80, 70, 60)
SMALLER = 0.8
PLAIN = Material("", 800.0, 0.0, 0.0, 0.0)
"""What `proxy` takes for a surface without materials."""


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
    rows, columns = surface.height_m.shape
    return {
        "digest": digest,
        "name": one_line(work.title),
        "shows": "surface",
        "rows": rows,
        "columns": columns,
        "extent_m": list(spline.extent_m),
        "height_m": [float(surface.height_m.min()), float(surface.height_m.max())],
        "levels": [{"step": 1, "rows": rows, "columns": columns}],
        "labels": 0 if spline.labels is None else int(spline.labels.max()) + 1,
        "label_bytes": 2,
        "materials": [{**asdict(material), "name": one_line(material.name)} for material in materials],
        "parts": None if surface.names is None else [one_line(name) for name in surface.names],
        "photo": work.picture is not None,
        "fine_photo": None,
        "layers": {},
    }


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
