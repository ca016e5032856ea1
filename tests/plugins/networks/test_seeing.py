"""What networks see lies where it is in the photograph; else the hand meets a face beside the head."""

from pathlib import Path

import cv2
import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

import tangible_networks.seeing as seeing
from onnx_models import mono
from tangible_core.data import PictureText
from tangible_core.errors import ConfigError
from tangible_networks.card import Card
from tangible_networks.hed import BLOCKS, hed_to_onnx, network, node
from tangible_networks.reading import read_texts
from tangible_networks.seeing import ANCHORS, find_faces, look
from tangible_networks.store import KnownNetwork

FACES = [KnownNetwork(name, Card(output={"means": "faces"}), Path(name)) for name in ("finder", "points")]


def bright_square(shape: tuple[int, int] = (120, 160)) -> np.ndarray:
    picture = np.zeros((*shape, 3), np.uint8)
    picture[30:90, 40:120] = 255
    return picture


class TestMaps:
    def test_without_networks_or_maps_nothing_is_seen(self, models: Path) -> None:
        seen = look(bright_square())
        assert (seen.figure, seen.borders, seen.faces_px) == (None, None, None)
        output = helper.make_tensor_value_info("same", TensorProto.FLOAT, [1, 3, "h", "w"])
        inputs = [helper.make_tensor_value_info("picture", TensorProto.FLOAT, [1, 3, "h", "w"])]
        graph = helper.make_graph([helper.make_node("Relu", ["picture"], ["same"])], "same", inputs, [output])
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
        onnx.save(model, models / "own.onnx")
        (models / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
        with pytest.raises(ConfigError, match="no map"):
            look(bright_square())

    def test_figure_lies_where_the_network_sees_it(self, models: Path) -> None:
        mono(models / "own.onnx")
        (models / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
        seen = look(bright_square())
        assert seen.figure is not None
        assert seen.figure.shape == (120, 160)
        assert np.array_equal(seen.figure > 0.5, bright_square()[..., 0] > 0)
        assert look(np.full((9, 1), 100, np.uint8)).figure is not None
        assert not look(bright_square() // 4).figure.any(), "nothing is sure enough to be a figure"

    @pytest.mark.parametrize("kind", [np.uint16, np.float32])
    def test_type_of_the_picture_does_not_matter(self, models: Path, kind: type) -> None:
        mono(models / "own.onnx")
        (models / "own.yaml").write_text("task: borders\noutput: {means: borders}\n")
        white = 65535 if kind is np.uint16 else 1
        alpha = np.full((120, 160, 1), white, kind)
        picture = np.concatenate([(bright_square() / 255 * white).astype(kind), alpha], axis=2)
        borders = look(picture).borders
        assert borders is not None
        assert np.allclose(borders, bright_square()[..., 0] / 255, atol=1e-5)

    def test_several_ask_and_the_network_runs_once(self, models: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        asked: list[np.ndarray] = []

        def answer(path: Path, runtime: str, inputs: dict, outputs: list[str]) -> list[np.ndarray]:
            asked.append(inputs["picture"])
            return [inputs["picture"][:, :1]]

        monkeypatch.setattr(seeing, "run", answer)
        (models / "own.onnx").write_bytes(b"a network")
        (models / "own.yaml").write_text("task: borders\ninput: {left: picture}\noutput: {means: borders}\n")
        maps = [look(picture).borders for picture in (bright_square(), bright_square(), 255 - bright_square())]
        assert len(asked) == 2
        assert np.array_equal(maps[0], maps[1])
        assert np.array_equal(maps[0], 1 - maps[2])
        (models / "own.onnx").write_bytes(b"another")
        look(bright_square())
        assert len(asked) == 3, "for another file"
        assert look(bright_square(), ("figure", "faces")).borders is None


class TestFaces:
    """A finder and a network of points that answer as they are asked, so that places are known exactly."""

    @pytest.mark.parametrize(("shape", "turn"), [((200, 300), 0.0), ((300, 200), 0.4), ((128, 128), -0.3)])
    def test_points_lie_on_the_face(self, monkeypatch: pytest.MonkeyPatch, shape: tuple[int, int], turn: float) -> None:
        centre, size = np.array([shape[1] * 0.55, shape[0] * 0.45]), 50.0
        right = np.array([np.cos(turn), np.sin(turn)])
        marks = np.stack([centre - 10 * right, centre + 10 * right])
        whole = float(max(shape))
        corner = np.array([shape[1] - whole, shape[0] - whole]) / 2

        def answer(path: Path, runtime: str, inputs: dict, outputs: list[str]) -> list[np.ndarray]:
            if path.name == "points":
                own = np.zeros((468, 3))
                own[:, :2] = 96 + np.linspace(0, 60, 468)[:, None] * [1, 0]
                own[:, 2] = -30
                return [own.reshape(1, -1, 1, 1), np.array([[[[5.0]]]])]
            boxes, scores = np.zeros((896, 16)), np.full(896, -20.0)
            if not answer.asked:
                index = 300
                boxes[index, :2] = ((centre - corner) / whole - ANCHORS[index]) * 128
                boxes[index, 2:4] = size / whole * 128
                boxes[index, 4:8] = (((marks - corner) / whole - ANCHORS[index]) * 128).ravel()
                scores[index] = 20
            answer.asked = True
            return [boxes[None], scores[None]]

        answer.asked = False
        monkeypatch.setattr(seeing, "run", answer)
        (points,) = find_faces(np.zeros((*shape, 3), np.float32), *FACES)
        assert np.allclose(points[0, :2], centre, atol=1e-3)
        assert np.allclose(points[-1, :2], centre + 60 * 75 / 192 * right, atol=1e-3), "turned and scaled as the face"
        assert np.allclose(points[:, 2], 30 * 75 / 192, atol=1e-3), "nearer is larger, in pixels"

    def test_what_the_points_refuse_is_no_face(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def answer(path: Path, runtime: str, inputs: dict, outputs: list[str]) -> list[np.ndarray]:
            if path.name == "points":
                return [np.zeros((1, 1404)), np.array([-1.0])]
            return [np.full((1, 896, 16), 20.0), np.full((1, 896), 20.0)]

        monkeypatch.setattr(seeing, "run", answer)
        assert find_faces(np.zeros((64, 64, 3), np.float32), *FACES).shape == (0, 468, 3)


class TestBorders:
    def test_converted_network_computes_what_torch_does(self, tmp_path: Path) -> None:
        import h5py
        import onnxruntime
        import torch
        from torch.nn.functional import conv2d, interpolate, max_pool2d

        random = np.random.default_rng(0)
        widths, layers, ins = (2, 3, 4, 3, 2), {}, 3
        for block, (count, width) in enumerate(zip(BLOCKS, widths, strict=True), 1):
            for layer in range(count):
                place = f"block{block}/layers/conv2d" + (f"_{layer}" if layer else "")
                layers[place] = random.normal(0, 0.4, (3, 3, ins, width)), random.normal(0, 0.1, width)
                ins = width
            layers[f"dsn{block}"] = random.normal(0, 1, (1, 1, width, 1)), random.normal(0, 0.1, 1)
        layers["fuse"] = random.normal(0, 1, (1, 1, 5, 1)), random.normal(0, 0.1, 1)
        with h5py.File(tmp_path / "w.h5", "w") as file:
            for place, arrays in layers.items():
                for number, array in enumerate(arrays):
                    file[f"{place}/vars/{number}"] = array.astype(np.float32)
        picture = torch.tensor(random.uniform(-1, 1, (1, 3, 37, 51)).astype(np.float32))

        def convolve(place: str, values: torch.Tensor) -> torch.Tensor:
            kernel, bias = (torch.tensor(array.astype(np.float32)) for array in layers[place])
            return conv2d(values, kernel.permute(3, 2, 0, 1), bias, padding=kernel.shape[0] // 2)

        values, sides = picture, []
        for block, count in enumerate(BLOCKS, 1):
            values = max_pool2d(values, 2, ceil_mode=True) if block > 1 else values
            for layer in range(count):
                values = convolve(f"block{block}/layers/conv2d" + (f"_{layer}" if layer else ""), values).relu()
            sides.append(interpolate(convolve(f"dsn{block}", values), (37, 51), mode="bilinear"))
        wanted = torch.sigmoid(convolve("fuse", torch.cat(sides, 1))).numpy()
        converted = hed_to_onnx(tmp_path / "w.h5")
        (found,) = onnxruntime.InferenceSession(converted).run(None, {"picture": picture.numpy()})
        assert np.allclose(found, wanted, atol=1e-5)
        assert converted == hed_to_onnx(tmp_path / "w.h5"), "a card names its digest"

    def test_written_network_is_what_the_library_of_onnx_writes(self) -> None:
        weight = np.arange(6, dtype=np.float32).reshape(1, 2, 3, 1)
        own = network([node("Conv", ["x", "w"], "y", kernel_shape=[3, 1], auto_pad="VALID", group=1)], {"w": weight},
                      {"x": [1, 2, "h", 300]}, {"y": [1, 1, "h", 300]})  # fmt: skip
        theirs = helper.make_model(
            helper.make_graph(
                [helper.make_node("Conv", ["x", "w"], ["y"], "y", kernel_shape=[3, 1], auto_pad="VALID", group=1)],
                "network",
                [helper.make_tensor_value_info("x", TensorProto.FLOAT, [1, 2, "h", 300])],
                [helper.make_tensor_value_info("y", TensorProto.FLOAT, [1, 1, "h", 300])],
                [numpy_helper.from_array(weight, "w")],
            ),
            opset_imports=[helper.make_opsetid("", 13)],
            ir_version=8,
        )
        parsed = onnx.load_from_string(own)
        for each in (*parsed.graph.node, *theirs.graph.node):
            attributes = sorted(each.attribute, key=lambda attribute: attribute.name)
            del each.attribute[:]
            each.attribute.extend(attributes)
        assert parsed == theirs


class TestTexts:
    @pytest.fixture
    def reader(self, models: Path) -> None:
        """A network that reads dark columns as `b` and light ones as nothing."""
        self.read_dark_as(models, "a\nb")

    def read_dark_as(self, models: Path, characters: str) -> None:
        names = [helper.make_tensor_value_info("x", TensorProto.FLOAT, [1, 3, 48, "w"])]
        out = [helper.make_tensor_value_info("steps", TensorProto.FLOAT, [1, "w", 3])]
        light = helper.make_node("ReduceMean", ["x"], ["light"], axes=[1, 2], keepdims=0)
        last = helper.make_node("Unsqueeze", ["light", "axis"], ["column"])
        classes = helper.make_node("MatMul", ["column", "weights"], ["product"])
        biased = helper.make_node("Add", ["product", "bias"], ["steps"])
        given = {"axis": np.array([2]), "weights": np.array([[1, 0, -1]], np.float32), "bias": np.float32([0, 0, 1])}
        weights = [numpy_helper.from_array(each, name) for name, each in given.items()]
        graph = helper.make_graph([light, last, classes, biased], "reader", names, out, weights)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
        helper.set_model_props(model, {"character": characters})
        onnx.save(model, models / "own.onnx")
        (models / "own.yaml").write_text("task: text\noutput: {means: text}\n")

    @pytest.mark.parametrize("turn_deg", [0, 12])
    def test_text_is_read_along_its_direction(self, reader: None, turn_deg: float) -> None:
        picture = np.full((300, 400, 3), 255, np.uint8)
        for left in (100, 160, 220, 280):
            picture[140:160, left : left + 20] = 0
        turn = cv2.getRotationMatrix2D((199.5, 149.5), turn_deg, 1)
        picture = cv2.warpAffine(picture, turn, (400, 300), borderValue=(255, 255, 255))
        rows, columns = np.nonzero(picture[..., 0] < 128)
        box = columns.min() / 400, rows.min() / 300, (columns.max() + 1) / 400, (rows.max() + 1) / 300
        given = PictureText("", tuple(map(float, box)), turn_deg)
        (read,) = read_texts(picture, [given])
        assert (read.content, read.box) == ("bbbb", given.box)
        assert read_texts(picture // 2 + 127, [given])[0].content == "", "faint bars are no letters"

    def test_letter_among_the_numbers_of_an_axis_is_one(self, models: Path) -> None:
        self.read_dark_as(models, "a\n7")
        picture = np.full((400, 400, 3), 255, np.uint8)
        picture[40:60, 100:110] = picture[40:60, 300:310] = 140  # too faint to be read alone
        boxes = [(100, 40, 110, 60), (300, 40, 310, 60)]
        for top in (120, 200):
            picture[top : top + 20, 60:80] = picture[top : top + 20, 95:110] = 0
            boxes.append((60, top, 110, top + 20))
        texts = [PictureText("", tuple(edge / 400 for edge in box)) for box in boxes]
        assert [text.content for text in read_texts(picture, texts)] == ["7", "", "77", "77"]

    def test_without_a_network_texts_stay_as_they_are(self, models: Path) -> None:
        given = PictureText("", (0.1, 0.1, 0.4, 0.2))
        assert read_texts(bright_square(), [given]) == (given,)
