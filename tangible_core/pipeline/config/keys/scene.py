"""The key `scene:`: a builtin name, files, or the block of a scene reader."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from ....errors import BrokenMethod, ConfigError, TangibleError
from ....scene.scene import Scene
from ....scene.scene_files import BUILTINS, SceneFiles, unknown_scene
from ..scene_readers import find_scene_reader, scene_reader_points, scene_readers
from .key import Forms, Key, Reading, Unchecked


@dataclass(frozen=True)
class SceneBlock(Key, Unchecked):
    """The key with the scene."""

    note: str = f"A builtin name ({', '.join(f'`{name}`' for name in sorted(BUILTINS))}), or files:"
    missing = "`scene:` is missing; name a builtin (builtin/motorcycle) or files {left:, right:}"

    def read(self, reading: Reading, block: Any) -> Any:
        source = reading.source
        try:
            reader = find_scene_reader(block)
        except BrokenMethod as error:
            return source.complain((self.name,), f"{self.name}: {error}")
        if reader is not None:
            return self._files(reading, reader, block)
        if not isinstance(block, str):
            return source.model((self.name,), SceneFiles, block)
        return block if block in BUILTINS else source.complain((self.name,), unknown_scene(block))

    def _files(self, reading: Reading, reader: Any, block: Any) -> SceneFiles | None:
        """Return the files that the block of a scene reader stands for; None after a complaint."""
        options = reading.source.model((self.name,), reader, block)
        try:
            return options and options.files()
        except TangibleError as error:
            return reading.source.complain((self.name,), f"{self.name}: {error}")

    def write(self, value: str | SceneFiles | Scene) -> Any:
        files = value.files if isinstance(value, Scene) else value
        if files is None:
            raise ConfigError(
                "scene: is made of arrays, and a file names files; save them, and make the scene of their paths"
            )
        return files if isinstance(files, str) else files.model_dump(mode="json", exclude_none=True)

    def settings(self) -> Iterable[str]:
        return (f"{self.name}=", *(f"{self.name}.{key}=" for key in scene_reader_points()))

    def models(self, value: Any) -> Mapping[tuple[str], BaseModel]:
        return {(self.name,): value} if isinstance(value, BaseModel) else {}

    def schema(self, forms: Forms) -> dict[str, Any]:
        blocks = (SceneFiles, *scene_readers(forms.distribution))
        return {"anyOf": [{"enum": sorted(BUILTINS)}, *map(forms.of, blocks)]}
