"""What runs a network: OpenCV, or onnxruntime where it is installed."""
# OpenCV's `dnn` and onnxruntime have no types.
# pyright: reportUnknownVariableType=false, reportUnknownMemberType=false, reportUnknownArgumentType=false

from collections.abc import Mapping, Sequence
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from threading import Lock
from typing import Any, Literal, Protocol

import numpy as np
from jaxtyping import Float32

from tangible_core.errors import BrokenMethod, ConfigError, shown

Runtime = Literal["opencv", "onnxruntime"]
OLDEST_OPENCV = 5
"""Version from which OpenCV runs transformers, and pictures of another size than the network was written for."""
_turn = Lock()
"""One network works at a time: none of them may be called from two threads, and each uses all threads that it may."""


class Network(Protocol):
    """A network that is loaded."""

    def run(self, inputs: Mapping[str, Float32[np.ndarray, "1 3 _ _"]], outputs: Sequence[str]) -> list[np.ndarray]:
        """The outputs of these names, an empty one being the first. Inputs by name; an empty one is the only one."""
        ...


def run(
    model: Path, runtime: Runtime, inputs: Mapping[str, Float32[np.ndarray, "1 3 _ _"]], outputs: Sequence[str]
) -> list[np.ndarray]:
    """What the network in this file gives.

    Raises: ConfigError if it cannot be loaded or does not take these inputs; BrokenMethod without what runs it.
    """
    found = model.stat()
    with _turn:
        try:
            network = _loaded(model, found.st_mtime_ns, found.st_size, runtime)
            return network.run(inputs, outputs)
        except (BrokenMethod, ConfigError, MemoryError):
            raise
        except Exception as error:  # whatever the runtime raises says what it does not like
            sizes = ", ".join(f"{name or 'input'} {each.shape}" for name, each in inputs.items())
            raise ConfigError(
                f"model: {model} cannot be run by {runtime} on {sizes}: {shown(' '.join(str(error).split()), 300)}; "
                f"check the card's inputs and outputs, or try `runtime: {_other(runtime)}`"
            ) from error


def _other(runtime: Runtime) -> Runtime:
    return "onnxruntime" if runtime == "opencv" else "opencv"


@lru_cache(maxsize=1)
def _loaded(model: Path, changed_ns: int, size: int, runtime: Runtime) -> Network:
    return _OpenCV(model) if runtime == "opencv" else _OnnxRuntime(model)


class _OpenCV:
    def __init__(self, model: Path) -> None:
        import cv2

        if int(cv2.__version__.partition(".")[0]) < OLDEST_OPENCV:
            raise BrokenMethod(
                f"networks need OpenCV {OLDEST_OPENCV} or newer, and this is {cv2.__version__}; "
                "pip install -U opencv-contrib-python-headless, or use `runtime: onnxruntime`"
            )
        self._net: Any = cv2.dnn.readNetFromONNX(str(model))

    def run(self, inputs: Mapping[str, Float32[np.ndarray, "1 3 _ _"]], outputs: Sequence[str]) -> list[np.ndarray]:
        for name, values in inputs.items():
            self._net.setInput(values, name)
        known = list(self._net.getUnconnectedOutLayersNames())
        return [np.array(each) for each in self._net.forward([name or known[0] for name in outputs])]


class _OnnxRuntime:
    def __init__(self, model: Path) -> None:
        from tangible_core.compiled.threads import thread_count  # imports numba

        try:
            library: Any = import_module("onnxruntime")
        except ImportError as error:
            raise BrokenMethod(
                f"runtime: onnxruntime is not installed ({error}); pip install 'tangible-images[onnx]', or "
                "onnxruntime-gpu for a graphics card"
            ) from error
        options = library.SessionOptions()
        options.intra_op_num_threads = thread_count()
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        options.log_severity_level = 3
        self._session: Any = library.InferenceSession(str(model), options, providers=library.get_available_providers())

    def run(self, inputs: Mapping[str, Float32[np.ndarray, "1 3 _ _"]], outputs: Sequence[str]) -> list[np.ndarray]:
        own = [each.name for each in self._session.get_inputs()]
        known = [each.name for each in self._session.get_outputs()]
        told = {name or own[0]: values for name, values in inputs.items()}
        return [np.array(each) for each in self._session.run([name or known[0] for name in outputs], told)]
