"""The process of a network's first run: else a damaged file ends the program."""

from pathlib import Path

import numpy as np
import onnx
import pytest

import onnx_models
from tangible_core.errors import BrokenMethod, ConfigError
from tangible_networks import runtimes

PICTURE = {"": np.random.default_rng(0).random((1, 3, 8, 9), np.float32)}
RUNTIMES = ("opencv", "onnxruntime")


@pytest.fixture
def loads(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The files that this process loads."""
    loads: list[Path] = []
    load = runtimes._load
    monkeypatch.setattr(runtimes, "_load", lambda model, *more: (loads.append(model), load(model, *more))[1])
    return loads


@pytest.mark.parametrize("runtime", RUNTIMES)
def test_first_run_of_a_content_is_in_another_process_and_gives_the_same(tmp_path: Path, loads, runtime):
    model = onnx_models.mono(tmp_path / "m.onnx")
    (first,) = runtimes.run(model, runtime, PICTURE, [""])
    assert loads == []
    np.testing.assert_allclose(first[0], PICTURE[""][0].mean(axis=0), atol=1e-6)
    (second,) = runtimes.run(model, runtime, PICTURE, [""])
    assert loads == [model]
    np.testing.assert_array_equal(first, second)
    copy = tmp_path / "copy.onnx"
    copy.write_bytes(model.read_bytes())
    runtimes.run(copy, runtime, PICTURE, [""])
    assert loads == [model, copy], "the content counts, not the name"
    onnx_models.stereo(copy, 4)
    runtimes.run(copy, runtime, {"left": PICTURE[""], "right": PICTURE[""]}, [""])
    assert loads == [model, copy], "nor a content that another one replaces"


def test_network_that_ends_its_process_is_refused_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """OpenCV quotes the kind of a node that it does not know, and dies of bytes that are not UTF-8."""
    data = onnx_models.mono(tmp_path / "m.onnx").read_bytes()
    assert data.count(b"Squeeze") == 1
    (tmp_path / "m.onnx").write_bytes(data.replace(b"Squeeze", b"Squ\xffeze"))
    with pytest.raises(ConfigError, match=r"m\.onnx is not an ONNX file, or is damaged; fetch it again$"):
        runtimes.run(tmp_path / "m.onnx", "opencv", PICTURE, [""])
    monkeypatch.setattr(runtimes, "_inputs", lambda *_: {})  # as for a fault that nobody foresaw
    with pytest.raises(ConfigError) as refusal:
        runtimes.run(tmp_path / "m.onnx", "opencv", PICTURE, [""])
    (line,) = str(refusal.value).splitlines()
    assert "m.onnx ended the process that ran it with opencv (SIG" in line
    assert "fetch it again, or try `runtime: onnxruntime`" in line


def test_missing_runtime_in_the_other_process_is_that_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "onnxruntime.py").write_text("raise ImportError('none here')")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(BrokenMethod, match=r"none here.*pip install onnxruntime"):
        runtimes.run(onnx_models.mono(tmp_path / "m.onnx"), "onnxruntime", PICTURE, [""])


@pytest.mark.parametrize(
    "damage",
    [
        lambda graph: graph.node[0].input.append("damaged"),
        lambda graph: setattr(graph.node[0], "name", "damaged"),
        lambda graph: setattr(graph.node[0], "domain", "damaged"),
        lambda graph: graph.node[0].attribute.append(onnx.helper.make_attribute("damaged", 1)),
        lambda graph: graph.node[0].attribute.append(onnx.helper.make_attribute("auto_pad", "damaged")),
        lambda graph: graph.node[0].attribute.append(onnx.helper.make_attribute("pads", ["damaged"])),
        lambda graph: graph.output.append(onnx.helper.make_tensor_value_info("damaged", 1, [1])),
        lambda graph: graph.output.append(onnx.helper.make_tensor_value_info("x", 1, ["damaged"])),
        lambda graph: setattr(graph.initializer[0], "name", "damaged"),
        lambda graph: setattr(graph, "name", "damaged"),
    ],
)
def test_text_that_is_not_utf_8_is_refused_wherever_it_stands(tmp_path: Path, damage):
    model = onnx.load(onnx_models.mono(tmp_path / "m.onnx"))
    damage(model.graph)
    data = model.SerializeToString()
    assert b"damaged" in data
    (tmp_path / "m.onnx").write_bytes(data.replace(b"damaged", b"damag\xe9d"))
    with pytest.raises(ConfigError, match="is not an ONNX file, or is damaged"):
        runtimes.read_inputs(tmp_path / "m.onnx")


def test_kornia_builds_both_networks_of_its_cards_and_downloads_nothing(tmp_path: Path, monkeypatch):
    import torch
    from kornia.core import download
    from kornia.filters.dexined import DexiNed

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a run downloads")

    monkeypatch.setattr("urllib.request.urlopen", refuse)
    monkeypatch.setattr(download, "load_state_dict_from_url", refuse)
    torch.manual_seed(0)
    network = DexiNed(pretrained=False).eval()
    torch.save(network.state_dict(), tmp_path / "edges.pth")
    picture = np.random.default_rng(0).normal(0, 100, (1, 3, 32, 48)).astype(np.float32)
    (edges,) = runtimes._load(tmp_path / "edges.pth", 0, 0, "kornia").run({"": picture}, [""])
    with torch.inference_mode():
        np.testing.assert_allclose(edges, network(torch.from_numpy(picture)).sigmoid().numpy(), atol=1e-6)

    depth = onnx_models.mono(tmp_path / "depth.onnx", names=("pixel_values", "predicted_depth"))
    (found,) = runtimes._load(depth, 0, 0, "kornia").run({"": picture}, [""])
    np.testing.assert_allclose(found[0, 0], picture[0].mean(axis=0), rtol=1e-4, atol=1e-3)
