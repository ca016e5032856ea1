"""Runtimes of networks: OpenCV, or onnxruntime or kornia if installed.

A damaged file can end the process that runs it, so the first run of a file is in a process of its own. The cache
remembers by its content and the version of the runtime that it ran; all later runs are in this process.
"""
# OpenCV's `dnn` and onnxruntime have no types, kornia's builders have not all.

import hashlib
import json
import os
import pickle
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from shutil import copyfile
from signal import Signals
from subprocess import DEVNULL, PIPE, Popen
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any, Protocol

import numpy as np

from tangible_core.data import Calibration
from tangible_core.errors import BrokenMethod, ConfigError, shown
from tangible_core.files import content_digest
from tangible_core.pipeline.engine import Cache
from tangible_core.provenance.versions import of_imported
from tangible_core.runtime import command, cv2, pipe_end
from tangible_core.runtime.system import exit_with_parent

from .card import Runtime
from .onnx_file import Shape, read_inputs

TFLITE, TORCH = ".tflite", ".pth"
"""The suffixes of networks in the format of TensorFlow Lite, which OpenCV alone runs here, and of weights for torch,
which kornia builds the network for."""
LIBRARIES: Mapping[Runtime, tuple[str, ...]] = {
    "opencv": ("cv2",), "onnxruntime": ("onnxruntime",), "kornia": ("kornia", "torch", "onnxruntime"),
}  # fmt: skip
# Oldest version of OpenCV that runs transformers, and pictures of another size than the network's own.
OLDEST_OPENCV = 5
RAN = Calibration(1.0, 1.0)  # entry of the cache that marks a file as run: its key says all
# Lock for one network at a time: none is thread-safe, and each uses all threads itself.
_lock = Lock()


class Network(Protocol):
    """A loaded network."""

    def run(self, inputs: Mapping[str, np.ndarray], outputs: Sequence[str]) -> list[np.ndarray]:
        """Return the named outputs. An empty name is the first output, or the only input."""
        ...


def run(model: Path, runtime: Runtime, inputs: Mapping[str, np.ndarray], outputs: Sequence[str]) -> list[np.ndarray]:
    """Run the network in this file. Raises: ConfigError for a network or inputs that cannot be; BrokenMethod."""
    status = model.stat()
    with _lock:
        try:
            if model.suffix not in (TFLITE, TORCH):
                _check_sizes(model, _inputs(model, status.st_mtime_ns, status.st_size), inputs)
            if (key := _key(model, runtime)) in (cache := Cache()):
                network = _load(model, status.st_mtime_ns, status.st_size, runtime)
                return network.run(inputs, outputs)
            arrays = _run_apart(model, runtime, inputs, outputs)
            cache.put(key, RAN)
            return arrays
        except (BrokenMethod, ConfigError, MemoryError):
            raise
        except Exception as error:  # runtimes raise errors of any type, with a useful message
            sizes = ", ".join(f"{name or 'input'} {item.shape}" for name, item in inputs.items())
            raise ConfigError(
                f"model: {model} cannot be run by {runtime} on {sizes}: {shown(' '.join(str(error).split()), 300)}; "
                f"check the card's inputs and outputs, or try `runtime: {_other_runtime(runtime)}`"
            ) from error


def _key(model: Path, runtime: Runtime) -> str:
    versions = of_imported(LIBRARIES[runtime])
    return hashlib.sha256(repr((__name__, content_digest(model), runtime, versions)).encode()).hexdigest()


def _run_apart(
    model: Path, runtime: Runtime, inputs: Mapping[str, np.ndarray], outputs: Sequence[str]
) -> list[np.ndarray]:
    """Run the network in a process of its own. Raises: what it raises there; ConfigError if the process dies."""
    with Popen(command(__name__), stdin=PIPE, stdout=PIPE, stderr=DEVNULL) as process:
        try:
            pickle.dump((os.getpid(), model, runtime, dict(inputs), list(outputs)), pipe_end(process.stdin))
            pipe_end(process.stdin).flush()
            answer = pickle.load(pipe_end(process.stdout))
        except (EOFError, pickle.UnpicklingError) as error:
            code = process.wait()
            how = Signals(-code).name if code < 0 else code
            raise ConfigError(
                f"model: {model} ended the process that ran it with {runtime} ({how}): it is damaged, or {runtime} "
                f"fails on it; fetch it again, or try `runtime: {_other_runtime(runtime)}`"
            ) from error
        finally:
            process.kill()
    if isinstance(answer, Exception):
        raise answer
    return answer


def main() -> None:
    """Run the network that arrives on standard input, in a process of its own, and answer on standard output."""
    answers = os.dup(1)
    os.dup2(2, 1)  # what a library prints is not the answer
    parent, model, runtime, inputs, outputs = pickle.load(sys.stdin.buffer)
    exit_with_parent(parent, sys.stdin.buffer)
    try:
        answer = _load(model, 0, 0, runtime).run(inputs, outputs)
    except (BrokenMethod, MemoryError) as error:
        answer = error
    except Exception as error:  # noqa: BLE001 - of a class that the other process may not know
        answer = RuntimeError(str(error))
    with os.fdopen(answers, "wb") as file:
        pickle.dump(answer, file)


def _check_sizes(model: Path, declared: Mapping[str, Shape], given: Mapping[str, np.ndarray]) -> None:
    """Raise a ConfigError for an input of another size than the network's only one: OpenCV would compute nonsense."""
    for name, values in given.items():
        if not values.ndim:  # a whole number
            continue
        takes = declared.get(name, ()) if name else next(iter(declared.values()), ())
        rows, columns = takes[2:] if len(takes) == 4 else (None, None)
        if rows not in (None, values.shape[2]) or columns not in (None, values.shape[3]):
            raise ConfigError(
                f"model: {model} takes pictures of {rows or 'any'} x {columns or 'any'} pixels alone, and would be run "
                f"on {values.shape[2]} x {values.shape[3]}; write `size_px: [{rows or 'ROWS'}, "
                f"{columns or 'COLUMNS'}]` below `input:` in its card"
            )


def _other_runtime(runtime: Runtime) -> Runtime:
    return "onnxruntime" if runtime == "opencv" else "opencv"  # kornia's cards allow no other


@lru_cache(maxsize=1)
def _inputs(model: Path, changed_ns: int, size: int) -> Mapping[str, Shape]:
    return read_inputs(model)


@lru_cache(maxsize=1)  # frames of a film use one network; those of a photograph run in turn, and HED holds 300 MiB
def _load(model: Path, changed_ns: int, size: int, runtime: Runtime) -> Network:
    kinds: dict[Runtime, Callable[[Path], Network]] = {
        "opencv": _OpenCV, "onnxruntime": _OnnxRuntime, "kornia": _Kornia,
    }  # fmt: skip
    return kinds[runtime](model)


class _OpenCV:
    def __init__(self, model: Path) -> None:
        self._net: Any
        if model.suffix == TFLITE:  # the new engine of OpenCV 5 gives the first output alone
            self._net = cv2.dnn.readNetFromTFLite(str(model), engine=cv2.dnn.ENGINE_CLASSIC)
            return

        if int(cv2.__version__.partition(".")[0]) < OLDEST_OPENCV:
            raise BrokenMethod(
                f"networks need OpenCV {OLDEST_OPENCV} or newer, and this is {cv2.__version__}; "
                "pip install -U opencv-contrib-python-headless, or use `runtime: onnxruntime`"
            )
        self._net = cv2.dnn.readNetFromONNX(str(model))

    def run(self, inputs: Mapping[str, np.ndarray], outputs: Sequence[str]) -> list[np.ndarray]:
        for name, values in inputs.items():
            self._net.setInput(values, name)
        names = list(self._net.getUnconnectedOutLayersNames())
        arrays = dict(zip(names, self._net.forward(names), strict=True))  # OpenCV 5 gives all outputs, or fails
        return [np.array(arrays[name or names[0]]) for name in outputs]


class _OnnxRuntime:
    def __init__(self, model: Path) -> None:
        from tangible_core.compiled import thread_count  # imports numba

        try:
            library: Any = import_module("onnxruntime")
        except ImportError as error:
            raise BrokenMethod(
                f"runtime: onnxruntime is not installed ({error}); pip install onnxruntime, or "
                "onnxruntime-gpu for a graphics card"
            ) from error
        options = library.SessionOptions()
        options.intra_op_num_threads = thread_count()
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        options.log_severity_level = 3
        self._session: Any = library.InferenceSession(str(model), options, providers=library.get_available_providers())
        self._options: type[Any] = library.RunOptions

    def run(self, inputs: Mapping[str, np.ndarray], outputs: Sequence[str]) -> list[np.ndarray]:
        own = [item.name for item in self._session.get_inputs()]
        names = [item.name for item in self._session.get_outputs()]
        feed = {name or own[0]: values for name, values in inputs.items()}
        wanted, options = [name or names[0] for name in outputs], self._options()
        with ThreadPoolExecutor(1) as beside:  # this thread hears Ctrl-C meanwhile, also of a network without end
            found = beside.submit(self._session.run, wanted, feed, options)
            try:
                return [np.array(item) for item in found.result()]
            except BaseException:
                options.terminate = True
                raise


class _Kornia:
    """A network that kornia builds: DexiNed from its weights, or Depth Anything from its ONNX file."""

    def __init__(self, model: Path) -> None:
        from tangible_core.compiled import thread_count  # imports numba

        try:
            self._torch: Any = import_module("torch")
            import_module("kornia")
        except ImportError as error:
            raise BrokenMethod(
                f"runtime: kornia is not installed ({error}); pip install torch kornia onnx onnxruntime"
            ) from error
        self._torch.set_num_threads(thread_count())
        self._network: Callable[[Any], Any] = (
            _build_dexined(model) if model.suffix == TORCH else _build_depth_anything(model)
        )

    def run(self, inputs: Mapping[str, np.ndarray], outputs: Sequence[str]) -> list[np.ndarray]:
        (picture,) = inputs.values()
        with self._torch.inference_mode():
            values = self._network(self._torch.from_numpy(picture)).numpy()
        return [values for _ in outputs]


def _build_dexined(model: Path) -> Callable[[Any], Any]:
    """Source: Soria et al., Dense extreme inception network for edge detection, WACV 2020."""
    network = import_module("kornia.filters.dexined").DexiNed(pretrained=False)
    network.load_state_dict(import_module("torch").load(model, map_location="cpu", weights_only=True))
    network.eval()
    return lambda picture: network(picture).sigmoid()


def _build_depth_anything(model: Path) -> Callable[[Any], Any]:
    """Source: Yang et al., Depth Anything V2, NeurIPS 2024."""
    builder = import_module("kornia.models.depth_estimation").DepthAnythingONNXBuilder
    name, plain = "depth-anything-v2-small", ("do_pad", "do_resize", "do_rescale", "do_normalize")
    with TemporaryDirectory() as folder:  # a cache in which all is there, so that kornia downloads nothing
        cache = Path(folder) / name
        cache.mkdir()
        copyfile(model, cache / "model.onnx")
        config = {"image_processor_type": "DPTImageProcessor", **dict.fromkeys(plain, False)}  # the card says all that
        (cache / "preprocessor_config.json").write_text(json.dumps(config))
        return builder.build(name, cache_dir=folder)
