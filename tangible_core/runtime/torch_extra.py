"""The optional torch extra: its import, or the words to install it, and the device to compute on."""

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Literal

from ..errors import BrokenMethod

if TYPE_CHECKING:
    import torch

TorchDevice = Literal["auto", "cpu", "cuda"]
"""Where to compute; `auto` takes a GPU when there is one."""


def need(name: str) -> ModuleType:
    """The module `torch` or `kornia`, or one of theirs.

    Raises: BrokenMethod saying how to install them.
    """
    try:
        return import_module(name)
    except ImportError as error:
        package = name.partition(".")[0]
        raise BrokenMethod(f"this method needs {package} ({error}); pip install 'tangible-images[torch]'") from error


def pick_device(wanted: TorchDevice) -> "torch.device":
    """Raises: BrokenMethod if torch is missing, or a GPU is asked for and there is none."""
    torch = need("torch")
    if wanted == "cuda" and not torch.cuda.is_available():
        raise BrokenMethod("torch_device is 'cuda', but torch finds no such GPU here; use 'auto' or 'cpu'")
    return torch.device("cuda" if wanted != "cpu" and torch.cuda.is_available() else "cpu")
