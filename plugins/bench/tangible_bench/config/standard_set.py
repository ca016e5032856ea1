"""The comparison of a standard set for which nobody wrote a file."""

import json
from pathlib import Path

from tangible_core.errors import ConfigError

from ..datasets import pairs
from ..tasks.depth_scenes import named_set

TEXT = """\
compare: depth
methods: [semi-global, {{use: opencv-sgbm, given: [max_disparity_px]}}, zncc, ssd]
scenes: [{scene}]
repeats: 1
calls: 1
"""


def comparison_of_set(name: str, folder: Path | None = None) -> str:
    """The text of a comparison file: the methods for pairs, with their defaults, once on each pair of a set.

    name: of the set, with `@Q` and its like for a size, `@test` for the pairs without truth. folder: where it
    lies; one of its name here if left out.
    Raises: ConfigError, PictureError as `datasets.pairs`, with the archive to fetch.
    """
    said = named_set(name)
    if said is None:
        raise ConfigError(f"{name}: is no standard set")
    folder = (folder or Path(said["set"])).absolute()
    pairs(said["set"], folder, **{key: value for key, value in said.items() if key != "set"})
    return TEXT.format(scene=json.dumps({**said, "folder": str(folder)}))
