"""The keys of cached results. Otherwise a changed option, file or program would be answered by an old result."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from tangible_core import load_method
from tangible_core.data import DisparityMap, SegmentMap, Views
from tangible_core.data.products import PRODUCTS
from tangible_core.materials.rules import MaterialRule
from tangible_core.pipeline.config.material_choice import MaterialChoice
from tangible_core.pipeline.config.methods import NamedMethod
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.pipeline.engine.engine import Engine
from tangible_core.plugins.interfaces import DepthEstimator, Segmenter
from tangible_core.plugins.registry import default_registry
from tangible_core.provenance import closure as closures
from tangible_core.provenance import versions
from tangible_core.relief import ReliefChoice
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.workspace import Workspace

KEPT = tuple(product for product in PRODUCTS if product != "touch")


FELT = """
felt:
  {{stiffness_n_per_m: {}, damping_n_s_per_m: 1.5, static_friction: 0.5, dynamic_friction: 0.4, source: guess}}
"""


class Ramp(DepthEstimator):
    """Disparity grows from left to right."""

    most_px: float | None = None
    weights: Path | None = None

    def estimate(self, views: Views) -> DisparityMap:
        return DisparityMap(np.tile(np.arange(views.shape[1], dtype=np.float32), (views.shape[0], 1)))


class Halves(Segmenter):
    """A segmenter of a left and a right half."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        labels = np.zeros(picture.shape[:2], np.int32)
        labels[:, picture.shape[1] // 2 :] = 1
        return SegmentMap(labels)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    picture = np.random.default_rng(0).random((20, 30)).astype(np.float32)
    picture[3, 5] = picture[3, 6] = picture[2, 5] = picture[4, 5] = picture[3, 4]
    np.save(tmp_path / "left.npy", picture)
    np.save(tmp_path / "right.npy", picture[:, ::-1])
    picture[3, 5] = np.nan
    np.save(tmp_path / "torn.npy", picture)
    return tmp_path


def pipeline(folder: Path, **parts) -> Engine:
    pair = SceneFiles(left=Path("left.npy"), right=Path("right.npy"))
    made = {
        "scene": pair,
        "want": "surface",
        "depth": NamedMethod("ramp", "tests 1.0", Ramp()),
        "texture": NamedMethod("halves", "tests 1.0", Halves()),
        "workspace": Workspace(width_m=0.03),
    }
    config = PipelineConfig(path=folder / "p.yaml", **(made | parts))
    return Engine(config, default_registry(), Cache(folder / "cache"))


def keys(folder: Path, **parts) -> dict[str, str]:
    """Return the keys of the stages alone, without those of their inputs."""
    return {product: stage.key for product, stage in pipeline(folder, **parts).stages.items()}


READ = closures._text
"""The reader of the files of modules, with the cache that is not emptied: no test edits them."""


def forget() -> None:
    for module in (closures, versions):
        for each in vars(module).values():
            if hasattr(each, "cache_clear") and each is not READ:
                each.cache_clear()


@pytest.fixture(autouse=True)
def _forget():
    yield
    forget()


class TestKeys:
    """Two that differ in one thing, by what the engine says and by what it gives."""

    def differ(self, product: str, one: Engine, other: Engine) -> bool:
        one.make(product)
        other.make(product)
        return outcome(other, product) == "ran"

    @pytest.mark.parametrize(
        ("product", "part", "key", "value"),
        [
            *(("relief", "workspace", *each) for each in (("width_m", 0.06), ("relief_m", 0.011), ("smooth_m", 0.001))),
            ("relief", "workspace", "holes", "cut"),
            *(("relief", "relief", *each) for each in (("by", "depth"), ("slope", 1), ("spread", 0.4), ("grain_m", 0))),
            ("relief", "relief", "accent_m", 0.002),
            ("disparity", "depth", "most_px", np.inf),
        ],
    )
    def test_keys_differ_for_every_option(self, folder: Path, product: str, part: str, key: str, value: object):
        before = {"workspace": Workspace(width_m=0.03), "relief": ReliefChoice(), "depth": Ramp()}[part]
        after = before.model_copy(update={key: value})
        one, same, other = (
            pipeline(folder, **{part: NamedMethod("ramp", "t 1", each) if part == "depth" else each})
            for each in (before, before, after)
        )
        assert not self.differ(product, one, same)
        assert self.differ(product, same, other)

    @pytest.mark.parametrize(("product", "method"), [("disparity", Ramp), ("segments", Halves)])
    def test_keys_differ_for_the_reduction_and_the_mask_of_pictures_and_the_version_of_a_method(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch, product: str, method: type
    ):
        coarse, fine = (pipeline(folder, workspace=Workspace(width_m=0.03, finest_m=each)) for each in (0.01, 0))
        assert self.differ(product, coarse, fine)
        if product == "disparity":
            assert fine.make(product).disparity_px[0].tolist() == list(range(30))
        whole, torn = (
            pipeline(folder, scene=SceneFiles(photo=Path(f"{each}.npy"), non_finite="mask"))
            for each in ("left", "torn")
        )
        np.testing.assert_array_equal(whole.scene.views.left, torn.scene.views.left)
        assert self.differ(product, whole, torn)
        assert torn.make(product).confidence[3, 5] == 0
        one, other = pipeline(folder), pipeline(folder)
        one.make(product)
        monkeypatch.setattr(method, "version", method.version + 1)
        other.make(product)
        assert outcome(other, product) == "ran"

    def test_keys_depend_on_files_that_are_read_and_on_trees_alone(self, folder: Path):
        parts = {"want": "relief", "relief": ReliefChoice(by="edges"), "scene": SceneFiles(photo=Path("left.npy"))}
        found = [
            keys(folder, **parts, texture=NamedMethod(name, version, load_method("texture", name)()))["relief"]
            for name, version in (("hierarchy", "1"), ("hierarchy", "2"), ("gradient", "1"), ("gradient", "2"))
        ]
        assert len({*found}) == 3
        assert found[2] == found[3]

        def of(content: bytes) -> str:
            (folder / "weights.bin").write_bytes(content)
            return keys(folder, depth=NamedMethod("ramp", "t 1", Ramp(weights=folder / "weights.bin")))["disparity"]

        assert of(b"one") != of(b"two")
        assert of(b"one") == of(b"one")

    @pytest.mark.parametrize("brings", [{}, {"disparity": Path("disparity.npy")}], ids=["found", "brought"])
    def test_keys_differ_for_the_cameras(self, folder: Path, brings: dict):
        np.save(folder / "disparity.npy", np.full((20, 30), 4.0, np.float32))
        pair = {"left": Path("left.npy"), "right": Path("right.npy"), "baseline_m": 0.1, **brings}
        one, other = (pipeline(folder, scene=SceneFiles(**pair, focal_px=each)) for each in (500.0, 600.0))
        assert self.differ("relief", one, other)

    @pytest.mark.parametrize(
        "choice",
        [
            {"by": {1: "sand"}},
            {"by": "rules"},
            {"rules": (MaterialRule.model_validate({"segment": 1, "material": "ice"}),)},
            {"by": "rules", "default": "sand"},
        ],
        ids=["by", "by rules", "rules", "default"],
    )
    def test_keys_differ_for_the_choice_of_materials(self, folder: Path, choice: dict):
        one = pipeline(folder, materials=MaterialChoice(by="rules" if "default" in choice else "roughness"))
        assert self.differ("materials", one, pipeline(folder, materials=MaterialChoice(**choice)))

    def test_keys_differ_for_the_library(self, folder: Path):
        def mine(stiffness: int) -> Engine:
            (folder / "mine.yaml").write_text(FELT.format(stiffness))
            return pipeline(folder, materials=MaterialChoice(by={1: "felt", 2: "felt"}, library=folder / "mine.yaml"))

        one = mine(200)
        one.make("materials")
        other = mine(300)
        assert self.differ("materials", one, other)
        assert other.make("materials").materials[0].stiffness_n_per_m == 300


def outcome(pipe: Engine, product: str) -> str:
    return {each.product: each.outcome for each in pipe.outcomes}[product]


def edit_module(monkeypatch: pytest.MonkeyPatch, module: str) -> None:
    """Pretend that the source of this module has changed."""

    def text(here: versions.Place):
        found = READ(here)
        return found._replace(content=b"edited") if here.name == module else found

    forget()
    monkeypatch.setattr(closures, "_text", text)


def other_version(monkeypatch: pytest.MonkeyPatch, distribution: str) -> None:
    read = versions._version.__wrapped__
    forget()
    monkeypatch.setattr(versions, "_version", lambda name: "0.1" if name == distribution else read(name))


def real(depth: str = "semi-global", texture: str = "gabor") -> dict[str, NamedMethod]:
    return {
        "depth": NamedMethod(depth, "tests 1.0", load_method("depth", depth)()),
        "texture": NamedMethod(texture, "tests 1.0", load_method("texture", texture)()),
    }


class TestCode:
    @pytest.mark.parametrize(
        ("module", "products"),
        [
            ("tangible_core.scene.scaling", {"disparity", "relief", "segments", "parts", "simplified"}),
            ("tangible_core.relief.shaping", {"relief"}),
            ("tangible_core.relief.slope_kernels", {"relief"}),
            ("tangible_core.scene.geometry", {"relief", "simplified"}),
            ("tangible_core.materials.rules", {"materials"}),
            ("tangible_core.data.surface", set(KEPT) - {"parts"}),
            ("tangible_core.pipeline.engine.stage", set(KEPT)),
            ("tangible_core.pipeline.engine.working_grid", set(KEPT)),
            ("tangible_core.pipeline.engine.stages.disparity", {"disparity"}),
            ("tangible_core.pipeline.engine.stages.relief", {"relief"}),
            ("tangible_core.pipeline.engine.stages.surface", {"surface"}),
            ("tangible_core.pipeline.engine.cache", set(KEPT)),
            ("tangible_core.pipeline.engine.engine", set()),
            ("tangible_depth.semi_global", {"disparity"}),
            ("tangible_depth.sgm.strips", {"disparity"}),
            ("tangible_core.compiled.threads", {"disparity", "figure", "segments"}),
            ("tangible_texture.energies.local_energy", {"segments"}),
        ],
    )
    def test_keys_depend_on_the_code_that_makes_the_product_only(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch, module: str, products: set[str]
    ):
        before = keys(folder, **real())
        edit_module(monkeypatch, module)
        after = keys(folder, **real())
        assert {product for product in KEPT if before[product] != after[product]} == products

    @pytest.mark.parametrize(
        ("distribution", "depth", "products"),
        [
            ("numpy", "semi-global", set(KEPT)),
            ("numba", "semi-global", {"disparity", "figure", "relief", "segments"}),
            ("llvmlite", "semi-global", {"disparity", "figure", "relief", "segments"}),
            ("torch", "semi-global", {"figure"}),
            ("torch", "kornia-zncc", {"disparity", "figure"}),
            ("kornia", "kornia-report", {"disparity", "figure"}),
            ("scipy", "semi-global", set(KEPT)),
            ("matplotlib", "semi-global", set()),
        ],
    )
    def test_keys_depend_on_the_versions_of_used_libraries(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch, distribution: str, depth: str, products: set[str]
    ):
        before = keys(folder, **real(depth))
        other_version(monkeypatch, distribution)
        after = keys(folder, **real(depth))
        assert {product for product in KEPT if before[product] != after[product]} == products

    def test_keys_depend_on_the_helpers_of_a_plugin(self, folder: Path, monkeypatch: pytest.MonkeyPatch):
        (folder / "acme_depth.py").write_text(
            "from acme_helper import SLOPE\n"
            "from tangible_core.plugins import DepthEstimator\n"
            "class Mine(DepthEstimator):\n"
            "    def estimate(self, views): ...\n"
        )
        (folder / "acme_helper.py").write_text("SLOPE = 1")
        monkeypatch.syspath_prepend(folder)
        chosen = NamedMethod("mine", "acme 1.0", import_module("acme_depth").Mine())
        before = keys(folder, depth=chosen)
        (folder / "acme_helper.py").write_text("SLOPE = 2")
        READ.cache_clear()
        forget()
        assert before["disparity"] != keys(folder, depth=chosen)["disparity"]

    def test_keys_of_a_method_at_a_prompt_are_always_new(self, folder: Path):
        made = {"__name__": "__prompt__"}
        exec(PROMPT, made)
        chosen = NamedMethod("mine", "prompt", made["Mine"]())
        assert keys(folder, depth=chosen)["disparity"] != keys(folder, depth=chosen)["disparity"]


PROMPT = """
from tangible_core.plugins.interfaces import DepthEstimator
class Mine(DepthEstimator):
    def estimate(self, views): ...
"""
