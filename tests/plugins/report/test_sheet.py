"""The exporter of sheets: the file that it writes, and the products that it draws."""

import numpy as np
import pytest
from PIL import Image

from tangible_core import Pipeline, Scene, show
from tangible_core.data import Work
from tangible_core.errors import OutputError
from tangible_core.scene.workspace import Workspace
from tangible_depth import Luminance
from tangible_report import Sheet
from tangible_texture import Gradient


@pytest.fixture
def pipeline() -> Pipeline:
    picture = np.zeros((24, 32, 3), np.uint8)
    picture[:, 16:] = 255
    return Pipeline(
        Scene.photo(picture), depth=Luminance(), texture=Gradient(), workspace=Workspace(width_m=0.04), cached=False
    )


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_export_to_sheet_writes_a_file_of_its_format(pipeline, tmp_path, ending):
    done = pipeline.export(tmp_path, [Sheet(format=ending)])
    [exported] = done.exports
    assert exported.outcome.outcome == "ran"
    assert [path.suffix for path in exported.files] == [f".{ending}"]


def test_sheet_of_an_export_describes_all_of_its_products(pipeline, tmp_path):
    [path] = pipeline.export(tmp_path, ["sheet"]).files["sheet"]
    described = Image.open(path).text["Description"]
    assert all(each in described for each in ("Input", "Segments and their materials", "Relief"))


def test_sheet_without_products_is_refused(tmp_path):
    with pytest.raises(OutputError, match="there is nothing to draw"):
        Sheet().write(Work("nothing", "en"), tmp_path / "nothing")


def test_show_draws_what_the_exporter_draws(pipeline):
    axes = show(pipeline.relief)
    assert axes.get_title() == Sheet().show(pipeline.relief).get_title() != ""
