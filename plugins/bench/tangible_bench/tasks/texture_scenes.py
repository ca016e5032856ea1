"""Scenes with true segments: mosaics of textures, smooth surfaces with edges, or pictures with labels."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self, cast

from pydantic import Field, model_validator

from tangible_core.data.pictures import size_in_words
from tangible_core.errors import PictureError, quoted
from tangible_core.scene.picture_files import read_labels, read_picture
from tangible_core.scene.workspace import Section
from tangible_core.testing.synthetic.texture_scenes import (
    KnownSegments,
    folder_textures,
    smooth_scene,
    texture_mosaic,
)

from ..datasets import matched
from .task import SceneSpec

PICTURE, LABELS = "picture.png", "labels.png"


class LabelGlobs(Section):
    """Files of one's own that belong together by what the stars of their patterns match."""

    picture: str
    """Pictures, such as `images/*.jpg`, from `folder` on."""
    labels: str
    """Their labels, a flat colour or grey for each segment: a pattern of as many stars."""


class TextureScene(SceneSpec):
    """A picture with true segments: one of mosaic, smooth, folder and pairs."""

    mosaic: Annotated[int, Field(ge=1)] | None = None
    """So many textures in curvy regions; grey alone tells nothing about them."""
    smooth: Annotated[int, Field(ge=1)] | None = None
    """So many regions of one grey each, under a slope of light and noise."""
    folder: Path | None = None
    """picture.png and labels.png, a flat colour or grey for each segment; or sub-folders with these. With `pairs`,
    where they lie."""
    pairs: LabelGlobs | None = None
    """Files of your own, matched by patterns."""
    only: tuple[str, ...] = ()
    """Names of such pairs; all of them if left out."""
    textures: Path | None = None
    """A folder of pictures of one texture each that a mosaic is made of, in place of the builtin ones."""
    width_px: Annotated[int, Field(ge=16, le=20_000)] = 512
    """Width of a mosaic or a smooth scene."""
    height_px: Annotated[int, Field(ge=16, le=20_000)] = 512
    """Height of a mosaic or a smooth scene."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Regions, textures and noise of a mosaic or a smooth scene."""

    @model_validator(mode="before")
    @classmethod
    def _beside_the_file(cls, said: Any) -> Any:
        """Patterns without a folder start at the file."""
        if isinstance(said, dict) and "pairs" in said:
            return {"folder": Path(), **cast("dict[str, Any]", said)}
        return cast(Any, said)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        given = [name for name in ("mosaic", "smooth", "pairs") if getattr(self, name) is not None]
        given += ["folder"] if self.folder is not None and "pairs" not in given else []
        if len(given) != 1:
            raise ValueError(
                f"a scene is one of mosaic, smooth, folder and pairs; this one is {' and '.join(given) or 'none'}"
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
        if self.pairs is not None:
            return {name: self.model_copy(update={"only": (name,)}) for name in self._matched()}
        if self.folder is None or (self.folder / PICTURE).exists():
            return {self._name(): self}
        found = sorted(each.parent for each in self.folder.glob(f"*/{PICTURE}"))
        if not found:
            raise PictureError(f"{self.folder}: neither it nor a folder in it holds {PICTURE} and {LABELS}")
        return {str(each.name): self.model_copy(update={"folder": each}) for each in found}

    def open(self) -> KnownSegments:
        """The picture and its labels. Raises: PictureError if they cannot be read, or there are too few textures."""
        shape = (self.height_px, self.width_px)
        if self.pairs is not None:
            (files,) = self._matched().values()
            return _read(files["picture"], files["labels"])
        if self.folder is not None:
            return _read(self.folder / PICTURE, self.folder / LABELS)
        if self.smooth is not None:
            return smooth_scene(self.smooth, shape, self.seed)
        assert self.mosaic is not None  # held by _one_kind
        textures = None if self.textures is None else folder_textures(self.textures)
        return texture_mosaic(self.mosaic, shape, self.seed, textures)

    def _matched(self) -> dict[str, dict[str, Path]]:
        assert self.folder is not None and self.pairs is not None  # held by _beside_the_file
        wanted = {"picture": self.pairs.picture, "labels": self.pairs.labels}
        found = matched(self.folder, wanted, ("picture", "labels"))
        if missing := next((name for name in self.only if name not in found), None):
            raise PictureError(f"{self.folder}: no pair in it is named {quoted(missing)}; there are {', '.join(found)}")
        return {name: found[name] for name in self.only} if self.only else found

    def _name(self) -> str:
        if self.folder is not None:
            return self.folder.name
        kind = f"smooth {self.smooth}" if self.mosaic is None else f"mosaic {self.mosaic}"
        of = f" of {self.textures.name}" if self.textures else ""
        return f"{kind}{of} {self.width_px}x{self.height_px}" + (f" seed {self.seed}" if self.seed else "")


def _read(picture_path: Path, labels_path: Path) -> KnownSegments:
    picture, labels = read_picture(picture_path), read_labels(labels_path)
    if picture.shape[:2] != labels.shape:
        raise PictureError(
            f"{picture_path} is {size_in_words(picture)} and {labels_path} {size_in_words(labels)}; they must be "
            "of one size"
        )
    return KnownSegments(picture, labels)
