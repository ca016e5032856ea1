"""The job that puts several laws on one surface, and says nothing of it: who compares blindly shall not know."""

import json
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError

from .bench import Bench, Job
from .making import felt


def laws(
    bench: Bench, text: str, path: Path, sets: list[str], others: list[dict[str, Any]]
) -> list[dict[str, Any]]:
    """What the force loop needs of the document's law, and then of others, blocks as `render:` has them.

    Raises: ConfigError if the document has no law, or a block is wrong; TangibleError as `Pipeline.make`.
    """
    first = bench.pipeline_of(text, path, sets)
    if first.config.render is None:
        raise first.config.missing("render")
    made = [felt(first)]
    for other in others:
        if not isinstance(other.get("use"), str):
            raise ConfigError("render: a law is named by {use: ...}")
        made.append(felt(bench.pipeline_of(text, path, [*sets, f"render={json.dumps(other)}"])))
    bench.pipeline = first
    return made


JOBS = {"laws": Job(laws)}
