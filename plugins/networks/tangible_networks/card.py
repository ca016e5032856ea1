"""The card of a network: its task, its file and where to get it, its inputs and the meaning of its output."""

import hashlib
from collections.abc import Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Annotated, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

from tangible_core.errors import ConfigError, ModelAbsent, did_you_mean
from tangible_core.files.yaml import parse_source, read_text

Three = tuple[float, float, float]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Means = Literal["disparity-px", "inverse-depth", "depth", "depth-m", "figure", "borders", "faces", "text"]
"""Meaning of an output. `disparity-px`: pixels of the input picture. `inverse-depth`: larger is nearer, without a unit.
`depth`: larger is farther, without a unit. `depth-m`: metres. `figure`, `borders`: from 0 to 1, how much a pixel
belongs to what stands out from its ground, or to a border that people would draw. `faces`: places of faces, or points
of one face. `text`: letters, a class each, and how sure they are at each step along a row."""
Runtime = Literal["opencv", "onnxruntime", "kornia"]
Task = Literal["depth", "figure", "borders", "faces", "text"]
"""The tasks of networks: depth of a picture or a pair, what stands out from its ground, borders, faces, and
what texts say."""


class _Part(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid")


class NetworkInput(_Part):
    """The input: float32 (1, 3, h, w) of each picture, (value of 0..1 times `white` - mean) / std."""

    left: str = ""
    """Name of the input for the picture, or the left view; empty for the only one."""
    right: str = ""
    """Name of the input for the right view; empty for a network of one picture."""
    order: Literal["rgb", "bgr"] = "rgb"
    """Order of the colours."""
    white: Positive = 1.0
    """Value of white before the mean is subtracted: 1 or 255."""
    mean: Three = (0.0, 0.0, 0.0)
    """Mean subtracted from each colour, in the order of the colours."""
    std: tuple[Positive, Positive, Positive] = (1.0, 1.0, 1.0)
    """Standard deviation by which each colour is divided."""
    multiple: Annotated[int, Field(ge=1, le=1024)] = 1
    """Number of which height and width must be multiples."""
    fit: Literal["pad", "resize"] = "pad"
    """Way to reach a multiple: `pad` repeats the last row and column, `resize` changes the picture's size a little."""
    size_px: tuple[Annotated[int, Field(ge=1, le=20_000)], Annotated[int, Field(ge=1, le=20_000)]] | None = None
    """Height and width of a network with a fixed input size, to which each picture is resized."""
    trained_px: tuple[Annotated[int, Field(ge=1, le=20_000)], Annotated[int, Field(ge=1, le=20_000)]] | None = None
    """Height and width of the pictures that the network was trained with, if known; a size far from it is reported."""

    constants: Mapping[str, int] = {}
    """Further inputs of one whole number each, by name, such as the number of tokens."""

    @model_validator(mode="after")
    def _two_inputs(self) -> Self:
        if self.right and not self.left:
            raise ValueError("a network for two views needs both inputs; give `left` as well as `right`")
        return self


class Package(_Part):
    """A published package that a network's file is part of."""

    pypi: str = ""
    """Name of the package on PyPI."""
    npm: str = ""
    """Name of the package on npm; exactly one of both is given."""
    version: Annotated[str, Field(coerce_numbers_to_str=True)]
    """Version of the package."""
    member: str
    """Path of the file in the package."""
    member_sha256: Annotated[str, Field(pattern="^([0-9a-f]{64})?$")] = ""
    """Digest of the file in the package if it is converted; otherwise it is the card's `sha256`."""
    convert: Literal["", "hed"] = ""
    """Conversion to ONNX: `hed` for the weights of HED for Keras."""
    download_bytes: Annotated[int, Field(ge=0)] = 0
    """Size of the package; 0 if unknown."""

    @model_validator(mode="after")
    def _one_registry(self) -> Self:
        if bool(self.pypi) == bool(self.npm):
            raise ValueError("a package is either on PyPI or on npm; give `pypi` or `npm`")
        return self

    def __str__(self) -> str:
        return f"{self.pypi or self.npm} {self.version} on {'PyPI' if self.pypi else 'npm'}"


class NetworkOutput(_Part):
    """The output: numbers (h, w), or with one or two leading dimensions of 1."""

    name: str = ""
    """Name of the output; empty for the first."""
    means: Means
    """Meaning of the numbers."""
    channel: Annotated[int, Field(ge=0)] | None = None
    """The number of its last axis that is taken, for an output (h, w, channels) such as points in space."""
    confidence: str = ""
    """Name of an output with the network's confidence, 0 to 1; empty without one."""
    normals: str = ""
    """Name of an output with normals (h, w, 3), whose slopes the depth gets; the output is then points (h, w, 3), both
    in a camera's coordinates: right, down, away. Empty without one."""


class Card(_Part):
    """The facts about a network that are needed to use it."""

    title: str = ""
    """Name of the network."""
    file: str = ""
    """Name of its published file, or of what it is converted to."""
    task: Task = "depth"
    """What the network is for."""
    recommended: bool = False
    """True for what `tangible networks add TASK` fetches."""
    improves: str = ""
    """What is better with it, in a few words."""
    source: Annotated[
        Annotated[str, Tag("address")] | Annotated[Package, Tag("package")],
        Discriminator(lambda given: "address" if isinstance(given, str) else "package"),
    ] = ""
    """Address to download it from, or the package that it is part of."""
    sha256: Annotated[str, Field(pattern="^([0-9a-f]{64})?$")] = ""
    """Digest that the file must have; empty if unknown."""
    size_bytes: Annotated[int, Field(ge=0)] = 0
    """Size of the file; 0 if unknown."""
    about_bytes: Annotated[int, Field(ge=0)] = 0
    """Published size of a file whose exact size is unknown; 0 if that is unknown too."""
    runtime: Runtime | None = None
    """The only library that can run it; None where OpenCV can."""
    licence: str = ""
    """Licence of the network."""
    trained_on: str = ""
    """The pictures that it was trained with."""
    verified: bool = True
    """False for a card that was written from published facts, without running the network."""
    input: NetworkInput = NetworkInput()
    output: NetworkOutput

    @property
    def is_stereo(self) -> bool:
        """True for a network of two views."""
        return bool(self.input.right)

    @property
    def fetch_hint(self) -> str:
        """The hint in error messages about where to get the network."""
        digest = f" (SHA-256 {self.sha256})" if self.sha256 else ""
        what = " ".join(filter(None, [self.title or "the network", self.file and f"as {self.file}"]))
        return f"fetch {what} from {self.source}{digest}" if self.source else f"put {what} there"


CARDS: Path = Path(__file__).parent / "cards"


@cache
def shipped_cards() -> Mapping[str, Card]:
    """Return the cards that are shipped, by name: one a file, in alphabetical order."""
    return {path.stem: _read_file(path) for path in sorted(CARDS.glob("*.yaml"))}


def read_card(card: str | Path) -> Card:
    """Return a shipped card by its name, or the card in a YAML file.

    Raises: ConfigError with every error in the file, or for an unknown name.
    """
    cards = shipped_cards()
    if str(card) in cards:
        return cards[str(card)]
    path = Path(card)
    if not path.is_file():
        raise ConfigError(
            f"card: {card} is neither a file nor one of {', '.join(cards)}{did_you_mean(str(card), cards)}; name "
            "one of these, or a YAML file that describes the network (docs/how-to/learned-depth.md)"
        )
    status = path.stat()
    return _read(path, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=16)
def _read(path: Path, changed_ns: int, size: int) -> Card:
    return _read_file(path)


def _read_file(path: Path) -> Card:
    source = parse_source(read_text(path), path, "a card is a mapping with `output: {means: ...}`")
    card = source.model((), Card, dict(source.tree))
    source.settle()
    assert card is not None
    return card


def check_file(model: Path, card: Card) -> None:
    """Check the file. Raises: ModelAbsent without a file, ConfigError if it is not the one of the card."""
    if not model.is_file():
        raise ModelAbsent(f"model: {model} does not exist, and nothing is downloaded; {card.fetch_hint}")
    if card.sha256 and (digest := sha256_hex(model)) != card.sha256:
        raise ConfigError(
            f"model: {model} is not the file of its card: its SHA-256 is {digest}, not {card.sha256}; "
            f"{card.fetch_hint}, or correct the card"
        )


def sha256_hex(path: Path) -> str:
    """Return the SHA-256 of a file, which is read once as long as its time and size stay."""
    status = path.stat()
    return _sha256(path, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=16)
def _sha256(path: Path, changed_ns: int, size: int) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def forget_digests() -> None:
    """Have each file read again by the next `sha256_hex`."""
    _sha256.cache_clear()
