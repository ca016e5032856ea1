"""The interface of a scene reader: a form of `scene:` in a pipeline file that stands for files."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import ConfigDict

from ..data.quantities import Quantities
from .scene_files import SceneFiles


class SceneReader(Quantities, ABC):
    """A form of the block `scene:`; its fields are the keys of the block.

    A package names its readers in the entry-point group `tangible.scene`. The name of the entry point is the key that
    only blocks of this form have, such as `set` in `scene: {set: kitti-2015, name: 000000_10}`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    @abstractmethod
    def files(self) -> SceneFiles:
        """Find the files of the scene. Raises: TangibleError."""

    @classmethod
    def suggest(cls, key: str, block: Mapping[str, Any]) -> Iterable[str]:
        """Return values of this key for the completion in a shell; block: the keys of `scene:` said so far."""
        return ()
