"""The optional extras and above all torch: their import, the way to install them, and the device to compute on."""

import sys
from collections.abc import Generator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Literal

from ..errors import BrokenMethod, TangibleError
from .threads import limiters, thread_limit

if TYPE_CHECKING:
    import torch

TorchDevice = Literal["auto", "cpu", "cuda"]
"""The device to compute on; `auto` takes a GPU if there is one."""
_own_threads = 0  # torch's own number of threads, if it was limited when it was imported


def need(name: str, packages: str = "torch kornia", error_type: type[TangibleError] = BrokenMethod) -> ModuleType:
    """Import a module of an optional extra, of which these are the packages. Raises: an error that says what to do."""
    global _own_threads
    fresh = "torch" not in sys.modules
    try:
        module = import_module(name)
        if fresh and (limit := thread_limit()) is not None:
            torch = import_module("torch")
            _own_threads = torch.get_num_threads()
            torch.set_num_threads(min(limit, _own_threads))
        return module
    except ImportError as error:
        package = name.partition(".")[0]
        raise error_type(f"this needs {package} ({error}); pip install {packages}") from error


@contextmanager
def torch_at_most(threads: int) -> Generator[None]:
    """Limit the threads of torch in this block; if it is imported within the block, from then on."""
    torch = sys.modules.get("torch")
    before = torch.get_num_threads() if torch else None
    if torch and before:
        torch.set_num_threads(min(threads, before))
    try:
        yield
    finally:
        if (torch_now := sys.modules.get("torch")) and (before or _own_threads):
            torch_now.set_num_threads(before or _own_threads)


limiters.append(torch_at_most)


def pick_device(choice: TorchDevice) -> "torch.device":
    """Return the device to compute on. Raises: BrokenMethod without torch, or without the requested GPU."""
    torch = need("torch")
    if choice == "cuda" and not torch.cuda.is_available():
        raise BrokenMethod("torch_device is 'cuda', but torch finds no such GPU here; use 'auto' or 'cpu'")
    return torch.device("cuda" if choice != "cpu" and torch.cuda.is_available() else "cpu")
