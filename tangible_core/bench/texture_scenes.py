"""Scenes with true segments: mosaics of textures, smooth surfaces with edges, or folders of pictures with labels."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from ..errors import PictureError, quoted
from ..scene.picture_files import read_labels, read_picture
from ..synthetic.texture_scenes import KnownSegments, folder_textures, smooth_scene, texture_mosaic
from .task import SceneSpec

PICTURE, LABELS = "picture.png", "labels.png"


class TextureScene(SceneSpec):
    """A picture with true segments: one of mosaic, smooth and folder."""

    mosaic: Annotated[int, Field(ge=1)] | None = None
    """So many textures in curvy regions; grey alone tells nothing about them."""
    smooth: Annotated[int, Field(ge=1)] | None = None
    """So many regions of one grey each, under a slope of light and noise."""
    folder: Path | None = None
    """picture.png and labels.png, a flat colour or grey for each segment; or sub-folders with these."""
    textures: Path | None = None
    """A folder of pictures of one texture each that a mosaic is made of, in place of the builtin ones."""
    width_px: Annotated[int, Field(ge=16, le=20_000)] = 512
    """Width of a mosaic or a smooth scene."""
    height_px: Annotated[int, Field(ge=16, le=20_000)] = 512
    """Height of a mosaic or a smooth scene."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Regions, textures and noise of a mosaic or a smooth scene."""

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        given = [name for name in ("mosaic", "smooth", "folder") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                f"a scene is one of mosaic, smooth and folder; this one is {' and '.join(given) or 'none'}"
            )
        if self.textures is not None and self.mosaic is None:
            raise ValueError(f"textures are what a mosaic is made of; leave them out of {given[0]}")
        return self

    @classmethod
    def named(cls, name: str) -> Mapping[str, Any]:
        """`mosaic/SEGMENTS` or `smooth/SEGMENTS`."""
        kind, _, segments = name.partition("/")
        if kind not in ("mosaic", "smooth") or not segments.isdecimal():
            raise ValueError(f"no scene is named {quoted(name)}; write mosaic/4, smooth/14 or {{folder: ...}}")
        return {kind: int(segments)}

    def expand(self) -> "Mapping[str, TextureScene]":
        """Itself, or one for each sub-folder that holds a picture with its labels."""
        if self.folder is None or (self.folder / PICTURE).exists():
            return {self._name(): self}
        found = sorted(each.parent for each in self.folder.glob(f"*/{PICTURE}"))
        if not found:
            raise PictureError(f"{self.folder}: neither it nor a folder in it holds {PICTURE} and {LABELS}")
        return {str(each.name): self.model_copy(update={"folder": each}) for each in found}

    def open(self) -> KnownSegments:
        """The picture and its labels. Raises: PictureError if they cannot be read, or there are too few textures."""
        shape = (self.height_px, self.width_px)
        if self.folder is not None:
            return _read(self.folder)
        if self.smooth is not None:
            return smooth_scene(self.smooth, shape, self.seed)
        assert self.mosaic is not None  # held by _one_kind
        textures = None if self.textures is None else folder_textures(self.textures)
        return texture_mosaic(self.mosaic, shape, self.seed, textures)

    def _name(self) -> str:
        if self.folder is not None:
            return self.folder.name
        kind = f"smooth {self.smooth}" if self.mosaic is None else f"mosaic {self.mosaic}"
        of = f" of {self.textures.name}" if self.textures else ""
        return f"{kind}{of} {self.width_px}x{self.height_px}" + (f" seed {self.seed}" if self.seed else "")


def _read(folder: Path) -> KnownSegments:
    picture, labels = read_picture(folder / PICTURE), read_labels(folder / LABELS)
    if picture.shape[:2] != labels.shape:
        raise PictureError(
            f"{folder}: {PICTURE} is {picture.shape[:2]} and {LABELS} {labels.shape}; they must be of one size"
        )
    return KnownSegments(picture, labels)
