"""Runtimes of networks, and the sizes and meanings of their maps; else a relief is shifted or upside down."""

from pathlib import Path

import numpy as np
import onnx
import pytest

import onnx_models
from tangible_core.data import Views
from tangible_core.errors import BrokenMethod, ConfigError
from tangible_networks import runtimes
from tangible_networks.card import NetworkInput
from tangible_networks.fitting import Fit, fit_size, map_in_strips, restore_size, tensor, to_disparity

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


PAD, RESIZE = NetworkInput(multiple=32), NetworkInput(multiple=14, fit="resize")


@pytest.mark.parametrize(
    ("shape", "takes", "most_px", "fit"),
    [
        ((40, 50), PAD, 10_000, ((40, 50), (64, 64))),
        ((64, 96), PAD, 64 * 96, ((64, 96), (64, 96))),
        ((200, 400), PAD, 20_000, ((100, 200), (128, 224))),
        ((100, 141), RESIZE, 100_000, ((98, 140), (98, 140))),
        ((105, 3), RESIZE, 100_000, ((112, 14), (112, 14))),
        ((100, 50), NetworkInput(size_px=(48, 64)), 10, ((48, 64), (48, 64))),
    ],
)
def test_size_is_below_the_limit_and_a_multiple(shape, takes: NetworkInput, most_px: int, fit):
    assert fit_size(shape, takes, most_px) == Fit(*fit)


def test_map_loses_the_padding_of_its_picture():
    picture = np.arange(18, dtype=np.float32).reshape(2, 3, 3)
    made = tensor(picture, NetworkInput(), Fit((2, 3), (3, 5)))
    assert made.shape == (1, 3, 3, 5)
    assert made[0, 0].tolist() == [[0, 3, 6, 6, 6], [9, 12, 15, 15, 15], [9, 12, 15, 15, 15]]
    fit, values = Fit((2, 3), (3, 5)), np.arange(15, dtype=np.float32).reshape(3, 5)
    for output in (values, values[None], values[None, None], values[None, ..., None]):
        found = restore_size(output, fit, (2, 3))
        assert found is not None
        assert found.tolist() == [[0, 1, 2], [5, 6, 7]]
    for output in (np.zeros((2, 3, 5)), np.zeros((1, 2, 3, 5)), np.zeros(5), np.zeros((0, 5))):
        assert restore_size(output, fit, (2, 3)) is None
    values = np.float32([[1, 1, 9, 9]] * 4)
    found = restore_size(values, Fit((8, 4), (8, 8)), (8, 4))
    assert found is not None
    assert found[:, :3].tolist() == [[1, 1, 1]] * 8


@pytest.mark.parametrize(
    ("height", "most_px", "multiple", "strips"),
    [
        (96, 960, 32, [(0, 96)]),
        (97, 990, 32, [(0, 96), (1, 97)]),
        (200, 1190, 32, [(0, 96), (72, 168), (104, 200)]),
        (150, 10, 1, [(0, 64), (48, 112), (86, 150)]),
    ],
)
def test_strips_overlap_and_have_the_rows_of_a_multiple(height: int, most_px: int, multiple: int, strips):
    seen = []

    def work(rows: slice) -> list[np.ndarray]:
        seen.append((rows.start, rows.stop))
        return [np.full((rows.stop - rows.start, 10), 7, np.float32)]

    (found,) = map_in_strips((height, 10), most_px, multiple, work)
    assert seen == strips
    assert found == pytest.approx(np.full((height, 10), 7))


def test_strips_fade_into_each_other():
    """No step between two rows is larger than that of a line over the overlap of 16 rows."""
    maps = iter([1.0, 2.0])
    (found,) = map_in_strips((112, 4), 4, 1, lambda rows: [np.full((64, 4), next(maps), np.float32)])
    assert (found[0, 0], found[-1, 0]) == (1, 2)
    assert np.flatnonzero(np.diff(found[:, 0]) > 0).tolist() == list(range(47, 64))
    assert np.diff(found[:, 0]).max() == pytest.approx(1 / 17, abs=1e-5)


VIEWS = Views(np.zeros((1, 4), np.uint8))
NAN = np.nan


@pytest.mark.parametrize(
    ("means", "numbers", "wanted"),
    [
        ("depth", [1, 2, 0, -1], [1, 0, NAN, NAN]),
        ("depth-m", [4, 2, 0, np.inf], [0, 1, NAN, NAN]),
        ("inverse-depth", [-3, -1, 0, 1], [0, 0.5, 0.75, 1]),
        ("inverse-depth", [2, 6, NAN, 4], [0, 1, NAN, 0.5]),
        ("disparity-px", [-2, 0, NAN, 5], [-2, 0, NAN, 5]),
        ("inverse-depth", [1, 1 + 2e-7, 1, 1], [0, 0, 0, 0]),
        ("depth", [NAN, NAN, 0, -1], [NAN] * 4),
    ],
)
def test_numbers_become_nearness_or_pixels(means, numbers, wanted):
    found = to_disparity(np.float32([numbers]), None, means, VIEWS)
    assert found.disparity_px.tolist() == [pytest.approx(wanted, nan_ok=True)]
    assert found.confidence.tolist() == [[float(not np.isnan(each)) for each in wanted]]
    assert found.unit == ("px" if means == "disparity-px" else "relative")


def test_confidence_is_a_share_and_none_where_nothing_is_known():
    found = to_disparity(np.float32([[1, 2, 3, NAN]]), np.float32([[0.25, 7, NAN, 0.5]]), "inverse-depth", VIEWS)
    assert found.confidence.tolist() == [[0.25, 1, 0, 0]]
