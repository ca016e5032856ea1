"""The card of a network: its file, its inputs and the meaning of its output."""

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import Annotated, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from tangible_core.errors import ConfigError, ModelAbsent, did_you_mean
from tangible_core.files.yaml import parse_source, read_text

Three = tuple[float, float, float]
"""A number for each colour."""
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Means = Literal["disparity-px", "inverse-depth", "depth", "depth-m"]
"""Meaning of an output. `disparity-px`: pixels of the input picture. `inverse-depth`: larger is nearer, without a unit.
`depth`: larger is farther, without a unit. `depth-m`: metres."""


class _Part(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


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

    @model_validator(mode="after")
    def _two_inputs(self) -> Self:
        if self.right and not self.left:
            raise ValueError("a network for two views needs both inputs; give `left` as well as `right`")
        return self


class NetworkOutput(_Part):
    """The output: numbers (h, w), or with one or two leading dimensions of 1."""

    name: str = ""
    """Name of the output; empty for the first."""
    means: Means
    """Meaning of the numbers."""
    confidence: str = ""
    """Name of an output with the network's confidence, 0 to 1; empty without one."""


class Card(_Part):
    """The facts about a network that are needed to use it."""

    title: str = ""
    """Name of the network."""
    file: str = ""
    """Name of its published file."""
    source: str = ""
    """Address to download it from."""
    sha256: Annotated[str, Field(pattern="^([0-9a-f]{64})?$")] = ""
    """Digest that the file must have; empty if unknown."""
    licence: str = ""
    """Licence of the network."""
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


MEAN, STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Mean and standard deviation of the colours of ImageNet, with which most networks are trained."""


def _preset(title: str, file: str, source: str, licence: str, takes: NetworkInput, means: Means) -> Card:
    return Card(
        title=title, file=file, source=source, licence=licence, verified=False, input=takes,
        output=NetworkOutput(means=means),
    )  # fmt: skip


PRESETS = {
    "c-fast-foundationstereo": _preset(
        "C-Fast-FoundationStereo",
        "the ONNX file of the model page",
        "https://huggingface.co/nvidia/c-fast-foundationstereo",
        "NVIDIA Open Model Agreement",
        NetworkInput(left="left_image", right="right_image", multiple=32, mean=MEAN, std=STD),
        "disparity-px",
    ),
    "depth-anything-v2-small": _preset(
        "Depth Anything V2 Small",
        "depth_anything_v2_vits_dynamic.onnx",
        "https://github.com/fabio-sim/Depth-Anything-ONNX/releases/tag/v2.0.0",
        "Apache-2.0 (larger ones: CC-BY-NC-4.0)",
        NetworkInput(multiple=14, fit="resize", mean=MEAN, std=STD, trained_px=(518, 518)),
        "inverse-depth",
    ),
    "depth-anything-3-small": _preset(
        "Depth Anything 3 Small",
        "an export of it to ONNX",
        "https://github.com/ByteDance-Seed/Depth-Anything-3",
        "Apache-2.0 (larger ones differ)",
        NetworkInput(multiple=14, fit="resize", mean=MEAN, std=STD, trained_px=(504, 504)),
        "depth",
    ),
    "midas-v2.1-small": _preset(
        "MiDaS v2.1 Small",
        "model-small.onnx",
        "https://github.com/isl-org/MiDaS/releases/tag/v2_1",
        "MIT",
        NetworkInput(fit="resize", size_px=(256, 256)),  # the file begins with the mean and the deviation
        "inverse-depth",
    ),
}
"""Cards that are shipped, written from published facts; no network is shipped."""


def read_card(card: str | Path) -> Card:
    """Return a preset by its name, or the card in a YAML file.

    Raises: ConfigError with every error in the file, or for an unknown name.
    """
    if str(card) in PRESETS:
        return PRESETS[str(card)]
    path = Path(card)
    if not path.is_file():
        raise ConfigError(
            f"card: {card} is neither a file nor one of {', '.join(PRESETS)}{did_you_mean(str(card), PRESETS)}; name "
            "one of these, or a YAML file that describes the network (docs/learned-depth.md)"
        )
    status = path.stat()
    return _read(path, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=16)
def _read(path: Path, changed_ns: int, size: int) -> Card:
    source = parse_source(read_text(path), path, "a card is a mapping with `output: {means: ...}`")
    card = source.model((), Card, dict(source.tree))
    source.settle()
    assert card is not None
    return card


def check_file(model: Path, card: Card) -> None:
    """Check the file. Raises: ModelAbsent without a file, ConfigError if it is not the one of the card."""
    if not model.is_file():
        raise ModelAbsent(f"model: {model} does not exist, and nothing is downloaded; {card.fetch_hint}")
    status = model.stat()
    if card.sha256 and (digest := _sha256(model, status.st_mtime_ns, status.st_size)) != card.sha256:
        raise ConfigError(
            f"model: {model} is not the file of its card: its SHA-256 is {digest}, not {card.sha256}; "
            f"{card.fetch_hint}, or correct the card"
        )


@lru_cache(maxsize=16)
def _sha256(path: Path, changed_ns: int, size: int) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
