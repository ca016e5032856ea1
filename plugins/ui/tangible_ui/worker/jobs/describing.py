"""A job that describes the surface on the screen at length, in a language of one's choice."""

from typing import Any

from tangible_core.description import Language, describe_at_length, facts, page_of
from tangible_core.description.at_length import tell
from tangible_core.pipeline.output.exporting import title_of
from tangible_core.scene.workspace import kind_of

from ..state import Bench, Job


def description(bench: Bench, language: Language) -> dict[str, Any] | None:
    """What there is to say, as text too and as a page of its own; nothing while there is no surface."""
    if bench.described is None:
        return None
    pipeline, seen = bench.described
    config, kind = pipeline.config, kind_of(pipeline.scene)
    title, parts = title_of(config, pipeline.scene), facts(seen.surface)
    told = tell(seen.surface, title, language, parts, kind)
    return {
        "digest": seen.digest,
        "title": told.title,
        "overview": " ".join(told.overview),
        "heading": told.heading,
        "parts": [{"label": each.label, "says": " ".join(each.sentences)} for each in told.parts],
        "left_out": told.left_out,
        "text": "\n".join(describe_at_length(seen.surface, title, language, parts, kind)),
        "html": page_of(seen.surface, title, language, parts, kind, named_in=config.language),
    }


JOBS = {"description": Job(description, quick=True)}
