"""A record in a notebook: a small picture with units, or a table where it has no picture."""
# pyright: reportUnknownMemberType=false
# (matplotlib leaves its keywords without types)

import base64
from contextlib import suppress
from dataclasses import fields
from html import escape
from io import BytesIO
from typing import Any, cast

import numpy as np

from ...data import MaterialMap, Record
from ...data.outcome import html_table
from ...errors import OutputError
from ...session import Recording
from .showing import show

DPI = 80


def as_html(record: Record) -> str:
    """A picture of what has one; of materials and other records a table of what is in them."""
    if not (isinstance(record, Recording) and not record.time_s.size):
        with suppress(OutputError):  # it has no picture
            return png_html(_drawn(record), type(record).__name__)
    if isinstance(record, MaterialMap):
        found = zip(record.materials, record.reasons, strict=True)
        rows = [(str(label), material.name, why) for label, (material, why) in enumerate(found)]
        what = "part" if any(why.startswith("part ") for why in record.reasons) else "segment"
        return html_table((what, "material", "why"), rows)
    return html_table(
        ("field", "value"), [(each.name, _said(getattr(record, each.name))) for each in fields(cast(Any, record))]
    )


def png_html(png: bytes, what: str) -> str:
    """A PNG inside of the page itself."""
    return f"<img alt='{escape(what)}' src='data:image/png;base64,{base64.b64encode(png).decode()}'>"


def _drawn(record: Record) -> bytes:
    from matplotlib import pyplot

    axes, file = show(record), BytesIO()
    figure = axes.get_figure(root=True)
    assert figure is not None
    try:
        figure.savefig(file, format="png", dpi=DPI)
    finally:
        pyplot.close(figure)
    return file.getvalue()


def _said(value: Any) -> str:
    if isinstance(value, np.ndarray):
        array = cast(np.ndarray, value)
        return f"{array.dtype} {array.shape}"
    return str(value)
