"""The exporter of sheets: if a case fails, an export lacks its sheet, or a sheet lacks products of the run."""

import numpy as np
import pytest
from PIL import Image

from tangible_core import Pipeline, Scene, show
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


def test_show_draws_what_the_exporter_draws(pipeline):
    axes = show(pipeline.relief)
    assert axes.get_title() == Sheet().show(pipeline.relief).get_title() != ""
