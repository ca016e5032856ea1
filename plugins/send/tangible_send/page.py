"""The exporter of a page that anybody can open and explore."""

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, final

from pydantic import Field

from tangible_core.data import Work
from tangible_core.errors import OutputError
from tangible_core.files import write_text
from tangible_core.plugins import Exporter, note
from tangible_legibility.words.languages import spoken_language
from tangible_web.address import page_file

log: logging.Logger = logging.getLogger(__name__)

MAX_BYTES = 2_000_000
"""The size of a whole file that mail programs and phones take without a question, bytes."""


@final
class Page(Exporter):
    """A page to send: one HTML file to see, hear and explore on any phone or computer, without a network.

    The picture is explored by finger, mouse, keyboard or game pad: the page says the names of parts, what they feel
    like, and how the ground rises and falls; borders click, textures hum and vibrate. The surface has the forces of
    `proxy` with `texture: false`, with heights to a micrometre where the size of the file allows that.
    """

    needs: ClassVar[tuple[str, ...]] = ("surface", "materials")

    most_bytes: Annotated[int, Field(ge=1_000_000, le=100_000_000)] = MAX_BYTES
    """The largest size of the file: the picture is compressed, and the surface made coarser, until it fits."""

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write one file. Raises: ConfigError if the page was not built; OutputError if it cannot be small enough."""
        from .packing import MIN_PHOTO, fits, make_page, pack, photo, surface_to_send

        script, style, licences = map(page_file, ("send.js", "send.css", "LICENSES.txt"))
        language = spoken_language(work.language, log)

        def page(data: Mapping[str, Any]) -> str:
            return make_page(work.title, language, work.language, data, script, style, licences)

        for spline in surface_to_send(work):
            data = pack(spline, work)
            room = self.most_bytes - len(page(data).encode())
            if room >= (0 if work.picture is None else MIN_PHOTO):
                break
        else:
            raise OutputError(f"this picture does not fit into {self.most_bytes} bytes; make `most_bytes` larger")
        if work.picture is not None:
            data["photo"] = photo(work.picture, room)
        if remark := fits(work, spline):
            note(log, remark)
        if work.film:
            note(log, "the page shows the first frame of the film")
        path = stem.with_name(f"{stem.name}-page.html")
        write_text(path, page(data))
        return (path,)
