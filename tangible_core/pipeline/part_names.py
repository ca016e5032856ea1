"""The names of parts that are read in the picture: their labels, and the labels that point to them."""

from ..data import PartMap
from ..drawing import find_marks
from ..drawing.labels import texts_in, tie_texts
from ..plugins.registry import Registry
from .config.model import PipelineConfig
from .engine.cache import Cache
from .engine.engine import Engine
from .engine.hooked import networks_identity, read_function


def read_part_names(config: PipelineConfig, registry: Registry) -> dict[int, str]:
    """Return the names of parts by label, as a network reads them in the picture; none without one.

    Of several texts that name one part, the highest letters count.
    Raises: TangibleError as `Engine.make`.
    """
    if not networks_identity(registry, "text"):
        return {}
    engine = Engine(config, registry, Cache())
    views = engine.scene.views
    if views is None:
        return {}
    marks = find_marks(views.left)
    texts = read_function(registry)(views.left, texts_in(marks))
    parts = engine.make_on_grid("parts") if any(text.content for text in texts) else None
    if not isinstance(parts, PartMap):
        return {}
    named_texts = zip(texts, tie_texts(marks, texts, parts.labels), strict=True)
    by_height = sorted(named_texts, key=lambda pair: pair[0].box[3] - pair[0].box[1])
    return dict(sorted({part: text.content for text, part in by_height if part is not None and text.content}.items()))
