"""Depth by a network that the user brings: else its map is wrong, or a bad file harms."""

import hashlib
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest

import onnx_models
from ctrl_c import hearing
from tangible_core import Pipeline, Scene
from tangible_core.data import Calibration, Views
from tangible_core.errors import ConfigError, ModelAbsent, PictureError
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.plugins.notes import collected
from tangible_core.scene.workspace import SUITS, FeltSize
from tangible_core.testing import run_checks
from tangible_core.testing.synthetic.scenes import wall
from tangible_depth import Auto, Luminance, Onnx, SemiGlobal
from tangible_depth import onnx as method
from tangible_networks import runtimes
from tangible_networks.normals import join_normals
from tangible_networks.onnx_file import read_inputs

RUNTIMES = ("opencv", "onnxruntime")
STEREO = "input: {left: left, right: right}\noutput: {means: disparity-px}\n"


@pytest.fixture(autouse=True)
def ran_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """Networks run in this process; the first run, in one of its own, is tested in its room."""
    monkeypatch.setattr(runtimes, "_key", lambda *_: "ran")
    monkeypatch.setattr(runtimes, "Cache", lambda: {"ran"})


@pytest.fixture(scope="module")
def networks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("networks")
    onnx_models.mono(folder / "mono.onnx")
    folder.joinpath("mono.yaml").write_text("output: {means: inverse-depth}\n")
    onnx_models.stereo(folder / "stereo.onnx")
    folder.joinpath("stereo.yaml").write_text(STEREO)
    return folder


@pytest.fixture
def card(tmp_path: Path):
    """Writes a card for a network, and gives the method."""

    def create(model: Path, text: str, **options) -> Onnx:
        (tmp_path / "card.yaml").write_text(text)
        return Onnx(model=model, card=str(tmp_path / "card.yaml"), **options)

    return create


def picture(rows: int = 40, columns: int = 50, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((rows, columns, 3), np.float32)


def nearness(values: np.ndarray) -> np.ndarray:
    return (values - values.min()) / (values.max() - values.min())


@pytest.mark.parametrize("runtime", RUNTIMES)
def test_inverse_depth_becomes_nearness_and_a_stereo_network_gives_pixels(networks: Path, runtime):
    seen, mono = picture(), Onnx(model=networks / "mono.onnx", runtime=runtime)
    found = mono.estimate(Views(seen))
    assert found.unit == "relative"
    np.testing.assert_allclose(found.disparity_px, nearness(seen.mean(axis=2)), atol=1e-5)
    assert (found.confidence == 1).all()
    assert mono.estimate(Views(seen, 1 - seen)).digest() == found.digest()
    found = Onnx(model=networks / "stereo.onnx", runtime=runtime).estimate(wall(6.0))
    assert found.unit == "px"
    assert np.median(np.abs(found.disparity_px - 6)) < 0.2


def test_input_is_normalised_as_in_the_card(tmp_path: Path, card):
    model, seen = onnx_models.mono(tmp_path / "m.onnx"), picture()
    plain = "output: {means: disparity-px}"
    told = card(model, f"input: {{white: 255, mean: [100, 0, 0], std: [2, 4, 1], order: bgr}}\n{plain}")
    blue_first = seen[..., ::-1] * 255
    wanted = ((blue_first - [100, 0, 0]) / [2, 4, 1]).mean(axis=2)
    np.testing.assert_allclose(told.estimate(Views(seen)).disparity_px, wanted, rtol=1e-4)
    eight = np.rint(seen * 255).astype(np.uint8)
    alike = card(model, plain).estimate(Views(eight)).disparity_px
    np.testing.assert_allclose(alike, (eight / 255).mean(axis=2), atol=1e-5)


@pytest.mark.parametrize("shape", [(40, 50), (1, 1), (3, 200), (32, 64)])
def test_padded_picture_gives_a_map_of_its_size(networks: Path, card, shape: tuple[int, int]):
    seen = picture(*shape)
    text = "input: {multiple: 32}\noutput: {means: disparity-px}"
    found = card(networks / "mono.onnx", text).estimate(Views(seen))
    np.testing.assert_allclose(found.disparity_px, seen.mean(axis=2), atol=1e-5)


@pytest.mark.parametrize("text", ["multiple: 32, fit: resize", "size_px: [32, 160]"])
def test_resized_pair_gives_pixels_of_the_picture(tmp_path: Path, card, text: str):
    """6 pixels of 320 are 3 of 160."""
    model = onnx_models.stereo(tmp_path / "s.onnx")
    told = card(model, f"input: {{left: left, right: right, {text}}}\noutput: {{means: disparity-px}}")
    found = told.estimate(wall(6.0))
    assert found.disparity_px.shape == wall(6.0).shape
    assert abs(np.median(found.disparity_px) - 6) < 1


def test_strips_bound_the_input_and_blend(networks: Path, monkeypatch: pytest.MonkeyPatch):
    sizes: list[int] = []
    real = method.run

    def run(model, runtime, inputs, outputs):
        sizes.extend(each.shape[2] * each.shape[3] for each in inputs.values())
        return real(model, runtime, inputs, outputs)

    monkeypatch.setattr(method, "run", run)
    views = wall(6.0, (400, 90))
    whole = Onnx(model=networks / "stereo.onnx").estimate(views).disparity_px
    parts = Onnx(model=networks / "stereo.onnx", most_px=9_000).estimate(views).disparity_px
    assert sizes[:2] == [36_000, 36_000]
    assert max(sizes[2:]) <= 9_000
    assert np.abs(parts - whole).max() < 0.5
    sizes.clear()
    near = Onnx(model=networks / "mono.onnx", most_px=9_000).estimate(Views(views.left))
    assert near.disparity_px.shape == (400, 90)
    assert len(sizes) == 1, "nearness of strips would have no common scale"
    assert sizes[0] <= 9_000 * 1.02


def test_metres_and_confidence_of_a_network_are_used(card, networks: Path, tmp_path: Path):
    depth = np.linspace(1, 5, 2000).reshape(40, 50).astype(np.float32)
    seen = np.repeat(depth[..., None] / 5, 3, axis=2)
    told = card(networks / "mono.onnx", "input: {white: 5}\noutput: {means: depth-m}")
    found = told.estimate(Views(seen, None, Calibration(900.0, 0.2, 31.0)))
    assert (found.unit, told.estimate(Views(seen)).unit) == ("px", "relative")
    np.testing.assert_allclose(found.disparity_px, 900 * 0.2 / depth - 31, rtol=1e-4)
    model = onnx_models.mono(tmp_path / "c.onnx", confidence=True)
    found = card(model, "output: {name: inverse_depth, means: inverse-depth, confidence: sure}").estimate(
        Views(picture())
    )
    np.testing.assert_allclose(found.confidence, picture().mean(axis=2) / 2, atol=1e-5)


class TestMistakes:
    def test_network_that_is_missing_or_another_is_refused(self, tmp_path: Path, networks: Path, card):
        with pytest.raises(ModelAbsent, match="needs a network"):
            Onnx().estimate(wall())
        with pytest.raises(ModelAbsent, match="fetch Depth Anything V2 Small"):
            Onnx(model=tmp_path / "no.onnx", card="depth-anything-v2-small").estimate(wall())
        digest = hashlib.sha256((networks / "mono.onnx").read_bytes()).hexdigest()
        text = "sha256: {}\noutput: {{means: inverse-depth}}"
        card(networks / "mono.onnx", text.format(digest)).estimate(Views(picture()))
        with pytest.raises(ConfigError, match=digest):
            card(networks / "mono.onnx", text.format("f" * 64)).estimate(Views(picture()))

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("output: {means: nearness}", r"card.yaml:1:.*means"),
            ("input: {right: r}\noutput: {means: depth}", "needs both inputs"),
            ("input: {std: [0, 1, 1]}\noutput: {means: depth}", r"card.yaml:1:.*std"),
            ("outptu: {means: depth}", "outptu"),
            ("output: [", "card.yaml"),
            ("input: {left: nothing}\noutput: {means: depth}", "cannot be run"),
            ("output: {name: nothing, means: depth}", "cannot be run"),
        ],
    )
    def test_invalid_card_is_refused_with_the_place(self, networks: Path, card, text: str, said: str):
        for runtime in RUNTIMES:
            with pytest.raises(ConfigError, match=said):
                card(networks / "mono.onnx", text, runtime=runtime).estimate(wall())

    def test_stereo_network_needs_a_pair_that_is_not_one_view(self, networks: Path):
        stereo, mono = Onnx(model=networks / "stereo.onnx"), Onnx(model=networks / "mono.onnx")
        assert stereo.needs_pair and not mono.needs_pair
        with pytest.raises(PictureError):
            stereo.estimate(Views(picture()))
        same = Views(wall().left, wall().left)
        assert stereo.skip(same)
        assert stereo.skip(wall()) is mono.skip(same) is None


def test_changed_network_or_card_changes_the_result(tmp_path: Path):
    onnx_models.mono(tmp_path / "m.onnx")
    (tmp_path / "m.yaml").write_text("output: {means: inverse-depth}")
    seen, cache = picture(), Cache(tmp_path / "cache")

    def create() -> tuple[str, np.ndarray]:
        pipeline = Pipeline(Scene.photo(seen), depth=Onnx(model=tmp_path / "m.onnx"), workspace={"finest_m": 0})
        pipeline.engine.cache = cache
        disparity = pipeline.disparity
        assert disparity is not None
        outcome = {each.product: each.outcome for each in pipeline.outcomes}["disparity"]
        return outcome, disparity.disparity_px

    assert (create()[0], create()[0]) == ("ran", "cached")
    (tmp_path / "m.yaml").write_text("output: {means: depth}\n")
    outcome, found = create()
    assert outcome == "ran"
    np.testing.assert_allclose(found, nearness(1 / seen.mean(axis=2)), atol=1e-4)


@pytest.mark.parametrize("runtime", RUNTIMES)
@pytest.mark.parametrize(("size", "only"), [((48, 64), "48 x 64"), ((48, "w"), "48 x any"), (("h", 64), "any x 64")])
def test_network_of_one_size_is_refused_with_another(tmp_path: Path, card, runtime, size, only: str):
    """OpenCV would run it, and give numbers that mean nothing."""
    model = onnx_models.stereo(tmp_path / "m.onnx", 4, size)
    with pytest.raises(ConfigError, match=rf"takes pictures of {only} pixels alone.*write `size_px: \["):
        card(model, STEREO, runtime=runtime).estimate(wall(2.0))
    told = STEREO.replace("right: right", "right: right, size_px: [48, 64]")
    assert card(model, told, runtime=runtime).estimate(wall(2.0)).unit == "px"


@pytest.mark.parametrize(
    ("size", "reported"), [((28, 34), True), ((29, 36), False), ((56, 69), False), ((57, 71), True)]
)
def test_size_far_from_that_of_the_training_is_reported(networks: Path, card, size, reported: bool):
    told = card(networks / "mono.onnx", "input: {trained_px: [40, 50]}\noutput: {means: inverse-depth}")
    with collected() as notes:
        told.estimate(Views(picture(*size)))
    assert any("trained with" in note and "most_px: 2000" in note for note in notes) == reported


def test_depth_of_a_network_gets_other_heights_than_a_photograph(
    networks: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def size(depth: object, **workspace: float) -> FeltSize:
        return Pipeline(Scene.photo(picture()), depth=depth, workspace=workspace).config.size

    monkeypatch.setenv("TANGIBLE_MODELS_DIR", str(tmp_path))
    assert size(Onnx(model=networks / "mono.onnx"))[1:3] == SUITS["depth"]
    assert size(Onnx(model=networks / "mono.onnx"), relief_m=0.006)[1:3] == (0.006, SUITS["depth"][1])
    assert size(Auto())[1:3] == SUITS["photograph"]
    onnx_models.mono(tmp_path / "a.onnx")
    (tmp_path / "a.yaml").write_text("output: {means: inverse-depth}")
    assert size(Auto())[1:3] == SUITS["depth"]


class TestAuto:
    @pytest.fixture(autouse=True)
    def folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        monkeypatch.setenv("TANGIBLE_MODELS_DIR", str(tmp_path / "models"))
        return tmp_path / "models"

    def test_pairs_and_films_are_matched_though_there_is_a_network(self, folder: Path):
        folder.mkdir()
        onnx_models.mono(folder / "a.onnx")
        (folder / "a.yaml").write_text("output: {means: inverse-depth}")
        assert Auto().estimate(wall(6.0)).digest() == SemiGlobal().estimate(wall(6.0)).digest()
        found = Auto().follow(wall(6.0))(wall(6.0)).digest()
        assert found == SemiGlobal(resolution="half").follow(wall(6.0))(wall(6.0)).digest()
        assert found != SemiGlobal().follow(wall(6.0))(wall(6.0)).digest()

    def test_first_network_for_one_picture_is_taken(self, folder: Path):
        folder.mkdir()
        for name, text in (("a", STEREO), ("b", ""), ("c", "output: {means: inverse-depth}"), ("d", "output: [")):
            onnx_models.mono(folder / f"{name}.onnx")
            if text:
                (folder / f"{name}.yaml").write_text(text)
        found = Auto().estimate(Views(picture()))
        np.testing.assert_allclose(found.disparity_px, nearness(picture().mean(axis=2)), atol=1e-5)
        assert {path.name for path in Auto().reads()} == {"c.onnx", "c.yaml"}

    def test_picture_without_a_network_is_luminance_with_a_warning(self, caplog: pytest.LogCaptureFixture):
        found = Auto().estimate(Views(picture()))
        assert found.digest() == Luminance().estimate(Views(picture())).digest()
        assert "no depth" in caplog.text


@pytest.mark.parametrize(("name", "kept"), [("mono", []), ("stereo", ["flat_pair_claims_nothing"])])
def test_networks_conform(networks: Path, name: str, kept: list[str]):
    """A network without a confidence output is confident in a picture without texture, a known failure."""
    results = list(run_checks("depth", "onnx", model=networks / f"{name}.onnx"))
    assert [result.name for result in results if not result.passed] == kept
    assert not any("not asked" in result.message for result in results)


class TestHostileFiles:
    """A network from somewhere is as little to be trusted as a picture: OpenCV dies of some of these."""

    MONO = "output: {means: inverse-depth}"

    def altered(self, folder: Path, alter: Callable[[onnx.TensorProto], None]) -> Path:
        """A copy of the network for one picture, with one of its weights altered."""
        model = onnx.load(onnx_models.mono(folder / "m.onnx"))
        (weight,) = (each for each in model.graph.initializer if each.name == "grey")
        alter(weight)
        (folder / "m.onnx").write_bytes(model.SerializeToString())
        return folder / "m.onnx"

    def demand_refusal(self, model: Path, card, said: str) -> None:
        for runtime in RUNTIMES:
            with pytest.raises(ConfigError, match=said):
                card(model, self.MONO, runtime=runtime).estimate(Views(picture()))

    @pytest.mark.parametrize("size", [-1, -(2**40), 2**40, 2**62])
    def test_impossible_size_of_a_weight_is_refused(self, tmp_path: Path, card, size: int):
        def alter(weight: onnx.TensorProto) -> None:
            weight.dims[0] = size

        self.demand_refusal(self.altered(tmp_path, alter), card, f"'grey' has the impossible size .{size}, 3, 1, 1")

    @pytest.mark.parametrize("place", ["../secret.bin", "{}/secret.bin", "in/../../secret.bin", "link.bin"])
    def test_weights_outside_the_folder_are_refused(self, tmp_path: Path, card, place: str):
        (tmp_path / "secret.bin").write_bytes(bytes(12))
        folder = tmp_path / "models"
        folder.mkdir()
        (folder / "link.bin").symlink_to(tmp_path / "secret.bin")
        model = self.altered(folder, partial(put_outside, place.format(tmp_path)))
        self.demand_refusal(model, card, "outside its folder")

    def test_weights_in_the_folder_are_read(self, tmp_path: Path, card):
        model = self.altered(tmp_path, partial(put_outside, "weights.bin"))
        (tmp_path / "weights.bin").write_bytes(np.float32([1, 0, 0]).tobytes())
        found = card(model, "output: {means: disparity-px}").estimate(Views(picture()))
        np.testing.assert_allclose(found.disparity_px, picture()[..., 0], atol=1e-6)

    @pytest.mark.parametrize("kept", [0, 1, 20, 60])
    def test_cut_file_is_refused(self, tmp_path: Path, card, kept: int):
        model = onnx_models.mono(tmp_path / "m.onnx")
        model.write_bytes(model.read_bytes()[:kept])
        self.demand_refusal(model, card, "fetch it again")

    def test_weights_of_own_graphs_are_checked_and_inputs_are_those_of_the_library(self, tmp_path: Path, card):
        bad = onnx.numpy_helper.from_array(np.zeros(1, np.float32), "bad")
        bad.dims[0] = -1
        model = onnx.load(onnx_models.endless(tmp_path / "m.onnx"))
        (loop,) = (node for node in model.graph.node if node.op_type == "Loop")
        for put in (
            lambda: loop.attribute[0].g.initializer.append(bad),
            lambda: model.graph.node.append(onnx.helper.make_node("Constant", [], ["k"], value=bad)),
        ):
            del loop.attribute[0].g.initializer[:]
            put()
            (tmp_path / "m.onnx").write_bytes(model.SerializeToString())
            self.demand_refusal(tmp_path / "m.onnx", card, "'bad' has the impossible size")
        model = onnx_models.stereo(tmp_path / "m.onnx", 4, (48, "w"))
        assert read_inputs(model) == {"left": (1, 3, 48, None), "right": (1, 3, 48, None)}
        old = onnx.load(model)
        old.graph.input.append(onnx.helper.make_tensor_value_info("grey", onnx.TensorProto.FLOAT, [1, 3, 1, 1]))
        # as files before ONNX 1.4 list their weights
        old.graph.input[1].type.tensor_type.shape.dim[2].dim_value = 0
        model.write_bytes(old.SerializeToString())
        assert read_inputs(model) == {"left": (1, 3, 48, None), "right": (1, 3, None, None)}


@pytest.mark.whole
@pytest.mark.timeout(60)
def test_network_without_end_hears_ctrl_c(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    model = onnx_models.endless(tmp_path / "m.onnx")
    (tmp_path / "m.yaml").write_text("output: {means: inverse-depth}")
    submit = ThreadPoolExecutor.submit

    def submit_and_interrupt(pool: ThreadPoolExecutor, *work: Any):
        threading.Timer(0.3, signal.pthread_kill, [threading.main_thread().ident, signal.SIGINT]).start()
        return submit(pool, *work)

    monkeypatch.setattr(ThreadPoolExecutor, "submit", submit_and_interrupt)
    with hearing(), pytest.raises(KeyboardInterrupt):
        Onnx(model=model, runtime="onnxruntime").estimate(Views(picture()))


def put_outside(place: str, weight: onnx.TensorProto) -> None:
    """Leave a weight's numbers to a file."""
    weight.ClearField("raw_data")
    weight.data_location = onnx.TensorProto.EXTERNAL
    for key, value in (("location", place), ("offset", "0"), ("length", "12")):
        weight.external_data.add(key=key, value=value)


def test_channels_of_points_and_normals_are_taken_with_their_steps(card, tmp_path: Path) -> None:
    """As MoGe-2 has them; its card names the only runtime that takes such a number."""
    text = "runtime: onnxruntime\ninput: {left: image, constants: {tokens: 3}}\n"
    text += "output: {name: points, channel: CHANNEL, means: disparity-px}\n"
    model, shown = onnx_models.points(tmp_path / "points.onnx"), picture()
    found = card(model, text.replace("CHANNEL", "2")).estimate(Views(shown))
    np.testing.assert_allclose(found.disparity_px, 3 * shown[..., 2], rtol=1e-6)
    with pytest.raises(ConfigError, match=r"points of .*3.*is not a map"):
        card(model, text.replace("CHANNEL", "3")).estimate(Views(shown))
    at = np.stack(np.meshgrid(np.arange(90) - 44.5, np.arange(70) - 34.5), axis=-1) / 80
    walls = np.where(at[..., 0] < 0, 0.6, 0.9)
    true = walls + 0.004 * np.sin(40 * at[..., 0]) * np.sin(50 * at[..., 1])
    rays = np.dstack([at, np.ones(true.shape)])
    places = true[..., None] * rays
    normals = np.cross(np.gradient(places, axis=0), np.gradient(places, axis=1))
    normals[:, 44:46] = normals[0, 0]
    model = onnx_models.camera(tmp_path / "camera.onnx", rays, normals / np.linalg.norm(normals, axis=2)[..., None])
    views = Views(np.repeat(walls[..., None], 3, axis=2).astype(np.float32))

    def off(output: str) -> float:
        nearness = card(model, f"output: {{{output}, means: depth}}").estimate(views).disparity_px
        return float(np.abs(nearness - (1 / true - 1 / true.max()) / np.ptp(1 / true)).mean())

    assert off("name: points, normals: normals") < 0.004 < 0.01 < off("name: points, channel: 2")
    with pytest.raises(ConfigError, match="both must be"):
        card(onnx_models.mono(tmp_path / "a.onnx", True), "output: {normals: sure, means: depth}").estimate(views)


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (6, 1), (0, 4), (6, 8)])
def test_points_that_no_camera_sees_keep_their_depth(shape: tuple[int, int]) -> None:
    points = np.stack([*-np.indices(shape)[::-1], np.ones(shape)], axis=-1)
    points[-1:] = np.nan
    depth = join_normals(points, np.zeros_like(points), np.ones(shape))
    np.testing.assert_array_equal(depth, np.nan_to_num(points[..., 2]))
