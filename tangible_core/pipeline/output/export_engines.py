"""The engines of one export: all of its files have the same parts, and its words the size and heights of its solid."""

from collections.abc import Sequence
from contextlib import suppress
from functools import cached_property
from typing import final

from ...errors import TangibleError
from ...plugins.interfaces import Exporter
from ..config.methods import NamedMethod
from ..engine.engine import Engine
from .legible import drawn_width_m, with_width


@final
class ExportEngines:
    """The engines of the exporters of one export, each for one width and one limit of slopes; they share products."""

    def __init__(self, engine: Engine, exporters: Sequence[NamedMethod[Exporter]]) -> None:
        self.engine = engine
        self.exporters = exporters
        self._engines = [engine]

    @cached_property
    def _common(self) -> Engine:
        """The engine of all but pins: where one of several simplifies parts, this is done once, for each width.

        Words and the like simplify parts only if none has a name.
        """
        sharing, config = [each for each in self.exporters if each.method.medium != "pins"], self.engine.config
        felt = [each for each in sharing if each.method.medium is not None]
        users = [each for each in (felt if config.part_names else sharing) if "simplified" in each.method.needs]
        if len(self.exporters) == 1 or not (users or config.simplify) or self.engine.stages["simplified"].skip:
            return self.engine
        engine = self.engine.with_config(config.with_values(felt_widths_m=(config.size.width_m,)))
        of_parts = [each for each in felt if any("simplified" in engine.all_inputs(need) for need in each.method.needs)]
        widths_m = tuple(sorted({*filter(None, map(self._width_m, of_parts))}))
        with suppress(TangibleError):  # of too many parts, each file says so, and those without parts are written
            self.engine.make("parts")
            return engine.with_config(config.with_values(felt_widths_m=widths_m)) if widths_m else engine
        return self.engine

    def engine_for(self, exporter: NamedMethod[Exporter]) -> Engine:
        """Return the engine for the width at which this exporter writes, and for its slopes."""
        engine = self.engine if exporter.method.medium == "pins" else self._common
        model = self._described or exporter if exporter.method.describes else exporter
        engine = with_width(engine, drawn_width_m(engine, exporter, model))
        relief = engine.config.relief
        if relief.slope and not model.method.limits_slopes and "slope" not in relief.model_fields_set:
            upright = relief.model_copy(update={"slope": 0.0})
            engine = engine.with_config(engine.config.with_values(relief=upright))
        for other in self._engines:
            engine.adopt(other)
        self._engines.append(engine)
        return engine

    @cached_property
    def _described(self) -> NamedMethod[Exporter] | None:
        """The exporter whose files the words of this export describe: the first solid, else the first page."""
        of_media = (each for medium in ("print", "swell") for each in self.exporters if each.method.medium == medium)
        return next(filter(self._width_m, of_media), None)

    def _width_m(self, exporter: NamedMethod[Exporter]) -> float | None:
        """Return the width in the files of an exporter; None where it is wrong, as the exporter's own outcome says."""
        with suppress(Exception):
            return with_width(self.engine, drawn_width_m(self.engine, exporter)).config.size.width_m
        return None
