"""A cut-out: products without their ground, for exporters."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...data import Figure, HapticSurface, PartMap, Record, Relief
from ...errors import ModelAbsent, PictureError
from ..engine.engine import Engine
from ..engine.networks import networks_identity


def remove_ground(engine: Engine, products: Mapping[str, Record | None]) -> dict[str, Record | None]:
    """Return the products of an engine without their ground, which has no height, and is the last part."""
    figure: Figure = engine.make_on_grid("figure") if networks_identity(engine.registry) else Figure()
    if figure.figure is None:
        raise ModelAbsent("a cut-out needs the network that sees figures; `tangible networks add figure` fetches it")
    if not figure.is_figure(figure.figure.shape).any():
        raise PictureError("nothing stands out from its ground in this picture, so nothing is cut out")
    return {name: flatten_ground(record, figure) for name, record in products.items()}


def flatten_ground(record: Record | None, figure: Figure) -> Any:
    """Return a product without its ground."""
    match record:
        case Relief():
            shape = record.height_m.shape
            return replace(record, height_m=np.where(figure.is_figure(shape), record.height_m, np.float32(0)))
        case HapticSurface():
            return replace(record, relief=flatten_ground(record.relief, figure))
        case PartMap():
            labels = np.where(figure.is_figure(record.labels.shape), record.labels, np.int32(record.count))
            return PartMap(labels, (*record.segments, max(record.segments) + 1))
        case _:
            return record
