"""The texts of a drawing: the parts that they name, its title, and the rest."""

from collections.abc import Callable, Sequence
from functools import lru_cache

from ..data import PartMap, PictureText
from ..drawing import Marks, PictureKind, find_marks
from ..drawing.labels import texts_in, tie_texts, title_among
from ..plugins.registry import Registry
from ..scene.scene import Scene
from .config.model import PipelineConfig
from .engine.cache import Cache
from .engine.engine import Engine
from .engine.hooked import networks_identity, read_function


def picture_texts(scene: Scene, registry: Registry) -> tuple[PictureText, ...]:
    """Return the texts of a drawing: those that its file states, and those in its picture, "" where nobody reads them.

    A page of text has none but those that its file states.
    """
    if scene.views is None or scene.kind.likely in (PictureKind.photograph, PictureKind.text):
        return scene.texts
    identity, marks = networks_identity(registry, "text"), find_marks(scene.views.left)
    return (*scene.texts, *_read(read_function(registry) if identity else None, identity, marks))


@lru_cache(maxsize=2)
def _read(read: Callable[..., tuple[PictureText, ...]] | None, identity: str, marks: Marks) -> tuple[PictureText, ...]:
    texts = texts_in(marks)
    return texts if read is None else tuple(read(marks.picture, texts))


def _tie(engine: Engine, texts: Sequence[PictureText]) -> list[tuple[PictureText, int | None]]:
    """Return the texts, the highest last, with the label of the part that each names, or None."""
    views, parts, labels = engine.scene.views, engine.make_on_grid("parts"), (None,) * len(texts)
    if views is not None and isinstance(parts, PartMap):
        labels = _tied_labels(find_marks(views.left), tuple(texts), parts)
    return sorted(zip(texts, labels, strict=True), key=lambda pair: pair[0].box[3] - pair[0].box[1])


@lru_cache(maxsize=2)
def _tied_labels(marks: Marks, texts: tuple[PictureText, ...], parts: PartMap) -> tuple[int | None, ...]:
    return tuple(tie_texts(marks.lines.centre, texts, parts.labels))


def read_labels(config: PipelineConfig, registry: Registry) -> tuple[str, dict[int, str]]:
    """Return the title and the names of parts by label, as the texts of the picture say; "" and none without any.

    Of several texts that name one part, the highest letters count.
    Raises: TangibleError as `Engine.make`.
    """
    engine = Engine(config, registry, Cache())
    if not (texts := [text for text in picture_texts(engine.scene, registry) if text.content]):
        return "", {}
    tied = _tie(engine, texts)
    names = {part: text.content for text, part in tied if part is not None}
    return title_among([text for text, part in tied if part is None]), dict(sorted(names.items()))


def title_and_rest(engine: Engine) -> tuple[str, tuple[PictureText, ...]]:
    """Return the title, "" without one, and the texts of the picture that are neither it nor the names of parts.

    Where names are given, the highest text of a part stands for its name, unless the file states which text names it.
    """
    config, scene = engine.config, engine.scene
    texts, title, named = picture_texts(scene, engine.registry), config.title.strip() or scene.title, config.part_names
    if texts and (named or not title):
        tied = _tie(engine, texts)
        names = {*named.values(), *filter(None, scene.segment_names)} if named else set[str]()
        highest = dict[int | None, PictureText]((part, text) for text, part in tied if part in named)
        rest = [
            pair
            for pair in tied
            if pair[0].content not in names and (any(scene.segment_names) or highest.get(pair[1]) is not pair[0])
        ]
        title = title or title_among([text for text, part in rest if part is None])
        texts = tuple(text for text in texts if any(text is other for other, _ in rest))
    return title, tuple(text for text in texts if not text.content or text.content != title)
