"""A page of a PDF: the picture without its texts, and the texts by its text layer."""
# pypdfium2's raw functions have no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false, reportMissingTypeStubs=false

from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from jaxtyping import UInt8

from ...data import PictureText
from ...drawing import PictureKind, picture_kind
from ...drawing.labels import title_among
from ...errors import PictureError
from ..formats.multi_picture import Notify, ignore
from .page import SIDE_PX, VectorPage, turn_box

_turn = Lock()  # lock around the library, which keeps its state in global variables


def read_pdf(path: Path, data: bytes, page: int | None = None, notify: Notify = ignore) -> VectorPage:
    """Read a page of a PDF, by default the first; no script is run. Raises: PictureError."""
    import pypdfium2

    with _turn:
        try:
            document: Any = pypdfium2.PdfDocument(data)
        except pypdfium2.PdfiumError as error:
            why = "is locked by a password; save it without one" if "password" in str(error).lower() else (
                f"cannot be read as PDF: {str(error).rstrip('.')}; save it again, or its page as PNG"
            )  # fmt: skip
            raise PictureError(f"{path}: {why}") from error
        try:
            count = len(document)
            if not 1 <= (page or 1) <= count:
                raise PictureError(f"{path}: has no page {page or 1}; its pages are 1 to {count}" if count else (
                    f"{path}: has no pages; save it again, or its page as PNG"
                ))  # fmt: skip
            if page is None and count > 1:
                notify(f"{path.name} has {count} pages, of which the first is taken; `page: 2` takes another")
            return _read_page(document, (page or 1) - 1)
        except pypdfium2.PdfiumError as error:
            raise PictureError(
                f"{path}: cannot be read as PDF: {str(error).rstrip('.')}; save its page as PNG"
            ) from error
        finally:
            document.close()


def _read_page(document: Any, number: int) -> VectorPage:
    from pypdfium2 import raw

    page = document[number]
    whole = _render(page)
    texts = _texts(page)
    if picture_kind(whole).likely == PictureKind.text:
        return VectorPage(whole, texts=texts, title=_title(document, texts), kind=PictureKind.text)
    for page_object in list(page.get_objects(filter=(raw.FPDF_PAGEOBJ_TEXT,), max_depth=1)):
        page.remove_obj(page_object)
    return VectorPage(_render(page), texts=texts, title=_title(document, texts))


def _render(page: Any) -> UInt8[np.ndarray, "h w 3"]:
    width, height = page.get_size()
    bitmap = page.render(scale=SIDE_PX / max(width, height, 1.0), rev_byteorder=True)
    return np.ascontiguousarray(bitmap.to_numpy()[..., :3])


def _title(document: Any, texts: tuple[PictureText, ...]) -> str:
    return " ".join(str(document.get_metadata_value("Title")).split()) or title_among(texts)


def _texts(page: Any) -> tuple[PictureText, ...]:
    """Return the lines of the text layer. Turned pages are turned back as they are shown."""
    layer, lines = page.get_textpage(), list[PictureText]()
    left_pt, bottom_pt, right_pt, top_pt = page.get_bbox()
    for number in range(layer.count_rects()):
        corners = np.reshape(layer.get_rect(number), (2, 2))
        content = " ".join(layer.get_text_bounded(*corners.reshape(-1).tolist()).split())
        if not content:
            continue
        shares = (corners - (left_pt, bottom_pt)) / (right_pt - left_pt, top_pt - bottom_pt)
        upright = shares[0, 0], 1 - shares[1, 1], shares[1, 0], 1 - shares[0, 1]
        lines.append(PictureText(content, turn_box(*upright, page.get_rotation())))
    return tuple(lines)
