"""Networks of a few kilobytes, made here: nothing is trained, and what each gives is known."""

import warnings
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

GREY = np.full((1, 3, 1, 1), 1 / 3, np.float32)


def mono(path: Path, confidence: bool = False) -> Path:
    """(1, 3, h, w) -> `inverse_depth` (1, h, w): the mean of the colours; and, if asked, `sure`: half of it."""
    nodes = [_node("Conv", ["image", "grey"], "g"), _node("Squeeze", ["g", "one"], "inverse_depth")]
    given = {"grey": GREY, "one": np.array([1])}
    gives = {"inverse_depth": [1, "h", "w"]}
    if confidence:
        nodes.append(_node("Mul", ["inverse_depth", "half"], "sure"))
        given["half"] = np.float32(0.5)
        gives["sure"] = [1, "h", "w"]
    return _save(path, nodes, {"image": [1, 3, "h", "w"]}, gives, given)


def stereo(path: Path, disparities: int = 16, size: tuple[int, int] | None = None) -> Path:
    """left, right -> `disparity` (1, 1, h, w): absolute differences in windows of 9 x 9, and the mean of the best.

    size: the only one that it takes.
    """
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


def vit_like(path: Path) -> Path:
    """Patches of 14 pixels, attention, GELU, cubic positions, a transposed convolution: what a transformer has."""
    import torch
    from torch import nn
    from torch.nn import functional as F

    class Block(nn.Module):
        def __init__(self):
            super().__init__()
            self.before, self.qkv, self.after = nn.LayerNorm(16), nn.Linear(16, 48), nn.Linear(16, 16)
            self.mix = nn.Sequential(nn.Linear(16, 32), nn.GELU(), nn.Linear(32, 16))

        def forward(self, x):
            q, k, v = self.qkv(self.before(x)).reshape(1, -1, 3, 2, 8).permute(2, 0, 3, 1, 4)
            x = x + self.after(F.scaled_dot_product_attention(q, k, v).transpose(1, 2).reshape(1, -1, 16))
            return x + self.mix(x)

    class Net(nn.Module):
        def __init__(self):
            super().__init__()
            self.embed, self.blocks = nn.Conv2d(3, 16, 14, 14), nn.Sequential(Block(), Block())
            self.up, self.head = nn.ConvTranspose2d(16, 4, 2, 2), nn.Conv2d(4, 1, 3, padding=1)
            self.places = nn.Parameter(torch.randn(1, 16, 4, 4))

        def forward(self, x):
            f = self.embed(x)
            f = f + F.interpolate(self.places, size=f.shape[2:], mode="bicubic", align_corners=False)
            n, c, h, w = f.shape
            t = self.blocks(f.flatten(2).transpose(1, 2)).transpose(1, 2).reshape(n, c, h, w)
            whole = F.interpolate(self.up(t), size=x.shape[2:], mode="bilinear", align_corners=True)
            return self.head(whole)[:, 0].relu() + 1

    return _export(path, Net(), [torch.rand(1, 3, 56, 70)], ["image"])


def raft_like(path: Path) -> Path:
    """Correlation of all pairs in a row, look-ups by grid_sample, updates that go round: what a RAFT has."""
    import torch
    from torch import nn
    from torch.nn import functional as F

    class Net(nn.Module):
        def __init__(self):
            super().__init__()
            self.see = nn.Sequential(nn.Conv2d(3, 8, 7, 4, 3), nn.InstanceNorm2d(8), nn.ReLU())
            self.update = nn.Conv2d(8 + 5, 9, 3, padding=1)

        def forward(self, left, right):
            a, b = self.see(left), self.see(right)
            n, _, h, w = a.shape
            alike, hidden, d = torch.einsum("nchw,nchv->nhwv", a, b), torch.tanh(a), torch.zeros_like(a[:, :1])
            columns = torch.arange(w).float().view(1, 1, 1, w)
            for _ in range(2):
                at = (columns - d).permute(0, 2, 3, 1) + torch.arange(-2, 3).float()
                grid = torch.stack([2 * at / (w - 1) - 1, torch.zeros_like(at)], -1).reshape(n * h * w, 1, 5, 2)
                seen = F.grid_sample(alike.reshape(n * h * w, 1, 1, w), grid, align_corners=True)
                out = self.update(torch.cat([hidden, seen.reshape(n, h, w, 5).permute(0, 3, 1, 2)], 1))
                hidden, d = torch.sigmoid(out[:, 1:]) * hidden, d + out[:, :1]
            return 4 * F.interpolate(d, scale_factor=4.0, mode="bilinear", align_corners=False)

    return _export(path, Net(), [torch.rand(1, 3, 48, 64)] * 2, ["left", "right"])


def _export(path: Path, net, inputs, names: list[str]) -> Path:
    import torch

    torch.manual_seed(0)
    for parameter in net.parameters():
        torch.nn.init.normal_(parameter, std=0.2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(
            net.eval(), tuple(inputs), str(path), input_names=names, output_names=["out"], opset_version=18,
            dynamo=False,
        )  # fmt: skip
    return path


def _node(kind: str, takes: list[str], gives: str, **options) -> onnx.NodeProto:
    return helper.make_node(kind, takes, [gives], **options)


def _save(path: Path, nodes, takes, gives, given) -> Path:
    def told(values):
        return [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in values.items()]

    known = [numpy_helper.from_array(np.asarray(value), name) for name, value in given.items()]
    graph = helper.make_graph(nodes, path.stem, told(takes), told(gives), known)
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9), path)
    return path
