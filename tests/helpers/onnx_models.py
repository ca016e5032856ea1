"""Networks of a few kilobytes, made here: nothing is trained, and what each gives is known."""

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

GREY = np.full((1, 3, 1, 1), 1 / 3, np.float32)


def mono(path: Path, confidence: bool = False, names: tuple[str, str] = ("image", "inverse_depth")) -> Path:
    """(1, 3, h, w) -> `inverse_depth` (1, h, w): the mean of the colours; and, if asked, `sure`: half of it."""
    image, nearness = names
    nodes = [_node("Conv", [image, "grey"], "g"), _node("Squeeze", ["g", "one"], nearness)]
    given = {"grey": GREY, "one": np.array([1])}
    gives = {nearness: [1, "h", "w"]}
    if confidence:
        nodes.append(_node("Mul", [nearness, "half"], "sure"))
        given["half"] = np.float32(0.5)
        gives["sure"] = [1, "h", "w"]
    return _save(path, nodes, {image: [1, 3, "h", "w"]}, gives, given)


def points(path: Path) -> Path:
    """image, the whole number `tokens` -> `points` (1, h, w, 3): the colours of each pixel, times the number."""
    nodes = [
        _node("Transpose", ["image"], "colours", perm=[0, 2, 3, 1]),
        _node("Cast", ["tokens"], "factor", to=TensorProto.FLOAT),
        _node("Mul", ["colours", "factor"], "points"),
    ]
    _save(path, nodes, {"image": [1, 3, "h", "w"], "tokens": []}, {"points": [1, "h", "w", 3]}, {})
    model = onnx.load(path)
    model.graph.input[1].type.tensor_type.elem_type = TensorProto.INT64
    onnx.save(model, path)
    return path


def camera(path: Path, rays: np.ndarray, normals: np.ndarray) -> Path:
    """image -> `points` (1, h, w, 3): rays times the red of each pixel, a half less away; `normals`, as they are."""
    nodes = [
        _node("Conv", ["image", "first"], "red"),
        _node("Transpose", ["red"], "depth", perm=[0, 2, 3, 1]),
        _node("Mul", ["depth", "rays"], "true"),
        _node("Sub", ["true", "half"], "points"),
        _node("Mul", ["given", "one"], "normals"),
    ]
    given = {"first": np.float32([1, 0, 0]).reshape(1, 3, 1, 1), "rays": np.float32(rays)[None]}
    given |= {"half": np.float32([0, 0, 0.5]), "given": np.float32(normals)[None], "one": np.float32(1)}
    gives = {name: [1, *rays.shape] for name in ("points", "normals")}
    return _save(path, nodes, {"image": [1, 3, *rays.shape[:2]]}, gives, given)


def stereo(path: Path, disparities: int = 16, size: tuple[int, int] | None = None) -> Path:
    """left, right -> `disparity` (1, 1, h, w): absolute differences in windows of 9 x 9, and the mean of the best."""
    h, w = size or ("h", "w")
    nodes = [
        _node("Conv", ["left", "grey"], "gl"),
        _node("Conv", ["right", "grey"], "gr"),
        _node("Pad", ["gr", "pads"], "padded", mode="edge"),
        _node("Shape", ["gr"], "shape"),
        _node("Gather", ["shape", "three"], "w", axis=0),
    ]
    given: dict[str, np.ndarray] = {
        "grey": GREY, "pads": np.array([0, 0, 0, disparities, 0, 0, 0, 0]), "three": np.array([3]),
        "sharp": np.float32(-60), "numbers": np.arange(disparities, dtype=np.float32).reshape(1, -1, 1, 1),
        "one": np.array([1]),
    }  # fmt: skip
    for d in range(disparities):
        given[f"from{d}"], given[f"axis{d}"] = np.array([disparities - d]), np.array([3])
        nodes += [
            _node("Add", [f"from{d}", "w"], f"to{d}"),
            _node("Slice", ["padded", f"from{d}", f"to{d}", f"axis{d}"], f"moved{d}"),
            _node("Sub", ["gl", f"moved{d}"], f"apart{d}"),
            _node("Abs", [f"apart{d}"], f"cost{d}"),
        ]
    nodes += [
        _node("Concat", [f"cost{d}" for d in range(disparities)], "cost", axis=1),
        _node("AveragePool", ["cost"], "mean", kernel_shape=[9, 9], pads=[4] * 4, count_include_pad=0),
        _node("Mul", ["mean", "sharp"], "score"),
        _node("Softmax", ["score"], "share", axis=1),
        _node("Mul", ["share", "numbers"], "parts"),
        _node("ReduceSum", ["parts", "one"], "disparity", keepdims=1),
    ]
    return _save(path, nodes, {name: [1, 3, h, w] for name in ("left", "right")}, {"disparity": [1, 1, h, w]}, given)


def endless(path: Path) -> Path:
    """The same, after a loop that never ends."""
    body = helper.make_graph(
        [_node("Identity", ["on"], "still"), _node("Identity", ["before"], "after")],
        "body",
        [
            helper.make_tensor_value_info("count", TensorProto.INT64, []),
            helper.make_tensor_value_info("on", TensorProto.BOOL, []),
            helper.make_tensor_value_info("before", TensorProto.FLOAT, None),
        ],
        [
            helper.make_tensor_value_info("still", TensorProto.BOOL, []),
            helper.make_tensor_value_info("after", TensorProto.FLOAT, None),
        ],
    )
    nodes = [
        _node("Conv", ["image", "grey"], "g"),
        _node("Loop", ["most", "yes", "g"], "looped", body=body),
        _node("Squeeze", ["looped", "one"], "inverse_depth"),
    ]
    given = {"grey": GREY, "one": np.array([1]), "most": np.array(2**62), "yes": np.array(True)}
    return _save(path, nodes, {"image": [1, 3, "h", "w"]}, {"inverse_depth": [1, "h", "w"]}, given)


def _node(kind: str, takes: list[str], gives: str, **options) -> onnx.NodeProto:
    return helper.make_node(kind, takes, [gives], **options)


def _save(path: Path, nodes, takes, gives, given) -> Path:
    def told(values):
        return [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in values.items()]

    known = [numpy_helper.from_array(np.asarray(value), name) for name, value in given.items()]
    graph = helper.make_graph(nodes, path.stem, told(takes), told(gives), known)
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9), path)
    return path
