"""If one of these fails, a TIFF is felt with other numbers than those it holds."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import tifffile

from tangible_core.scene.formats.pictures import read_labels, read_map, read_picture

CHANCE = np.random.default_rng(0)
ROWS, COLUMNS = 33, 50
WHOLE = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64")
FLOATING = ("float16", "float32", "float64")
COMPRESSIONS = ("none", "lzw", "deflate", "packbits", "zstd", "lzma")
LAYOUTS = ({}, {"rowsperstrip": 7}, {"tile": (16, 32)})


def numbers(dtype: str, *channels: int) -> np.ndarray:
    """Numbers that float32 holds exactly, with both signs where the type has them."""
    low, high = (0, 200) if dtype == "uint8" else (-100, 100) if dtype == "int8" else (-20000, 20000)
    low = 0 if dtype.startswith("u") else low
    values = CHANCE.integers(low, high, (ROWS, COLUMNS, *channels))
    return (values / 8 if dtype.startswith("f") else values).astype(dtype)


def predictors(dtype: str, compression: str) -> tuple[int, ...]:
    if compression in ("none", "packbits"):
        return (1,)
    return (1, 3) if dtype.startswith("f") else (1, 2)


@pytest.mark.parametrize("dtype", [*WHOLE, *FLOATING])
def test_map_has_the_numbers_of_the_file(tmp_path: Path, dtype: str):
    values = numbers(dtype)
    for order, compression, layout in product("<>", COMPRESSIONS, LAYOUTS):
        for predictor in predictors(dtype, compression):
            tifffile.imwrite(
                tmp_path / "a.tif", values, byteorder=order, compression=compression, predictor=predictor, **layout
            )
            what = f"{dtype} {order} {compression} {predictor} {layout}"
            np.testing.assert_array_equal(read_map(tmp_path / "a.tif"), values.astype(np.float32), what)


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
def test_colours_are_those_of_the_file_in_planes_and_side_by_side(tmp_path: Path, dtype: str):
    values = np.abs(numbers(dtype, 3))
    for order, compression, layout, planes in product("<>", ("none", "lzw", "deflate"), LAYOUTS, (False, True)):
        stored = np.moveaxis(values, 2, 0) if planes else values
        kind = {"planarconfig": "separate" if planes else "contig", "photometric": "rgb"}
        tifffile.imwrite(tmp_path / "a.tif", stored, byteorder=order, compression=compression, **kind, **layout)
        np.testing.assert_array_equal(read_picture(tmp_path / "a.tif"), values, f"{order} {compression} {layout}")


@pytest.mark.parametrize(("bits", "white"), [(1, 1), (2, 3), (4, 15), (12, 4095)])
def test_few_bits_are_brightness_in_a_picture_and_numbers_in_a_map(tmp_path: Path, bits: int, white: int):
    values = CHANCE.integers(0, white + 1, (ROWS, COLUMNS)).astype(np.uint8 if bits <= 8 else np.uint16)
    full = 255 if bits <= 8 else 65535
    for dark in ("minisblack", "miniswhite"):
        stored = values.astype(bool) if bits == 1 else values
        tifffile.imwrite(tmp_path / "a.tif", stored, bitspersample=bits, photometric=dark)
        np.testing.assert_array_equal(read_map(tmp_path / "a.tif"), values)
        bright = values if dark == "minisblack" else white - values
        np.testing.assert_array_equal(read_picture(tmp_path / "a.tif"), np.rint(bright * (full / white)))


def test_palette_gives_colours_to_a_picture_and_indices_to_labels(tmp_path: Path):
    values = CHANCE.integers(0, 3, (ROWS, COLUMNS)).astype(np.uint8)
    colours = CHANCE.integers(0, 256, (3, 256)).astype(np.uint16) * 257
    tifffile.imwrite(tmp_path / "a.tif", values, photometric="palette", colormap=colours)
    np.testing.assert_array_equal(read_picture(tmp_path / "a.tif"), np.moveaxis(colours[:, values] // 257, 0, 2))
    np.testing.assert_array_equal(read_labels(tmp_path / "a.tif"), values)


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
@pytest.mark.parametrize("kind", ["unassalpha", "assocalpha"])
def test_transparency_hides_pixels_of_a_picture_and_of_a_map(tmp_path: Path, dtype: str, kind: str):
    full = np.iinfo(dtype).max
    values, shown = numbers(dtype), CHANCE.random((ROWS, COLUMNS)) < 0.5
    alpha = (shown * full).astype(dtype)
    options = {"extrasamples": [kind], "photometric": "minisblack", "planarconfig": "contig"}
    tifffile.imwrite(tmp_path / "grey.tif", np.dstack([values, alpha]), **options)
    np.testing.assert_array_equal(read_map(tmp_path / "grey.tif"), np.where(shown, values, np.nan).astype(np.float32))
    picture = read_picture(tmp_path / "grey.tif")
    np.testing.assert_array_equal(picture, np.dstack([values, values, values, alpha]))
    colours = numbers(dtype, 3)
    tifffile.imwrite(
        tmp_path / "rgb.tif", np.dstack([colours, alpha]), photometric="rgb", extrasamples=[kind], compression="lzw"
    )
    np.testing.assert_array_equal(read_picture(tmp_path / "rgb.tif"), np.dstack([colours, alpha]))


@pytest.mark.parametrize(
    ("nodata", "dtype"),
    [("-9999", "float32"), ("-32768", "int16"), ("65535", "uint16"), ("-3.40282e+38", "float32"), ("1e20", "float64")],
)
def test_value_for_no_data_is_unknown(tmp_path: Path, nodata: str, dtype: str):
    values = numbers(dtype)
    missing = -np.finfo(np.float32).max if "e+38" in nodata else np.array(float(nodata)).astype(dtype)
    values[3:5, 7:20] = missing
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=[(42113, "s", 0, nodata, True)])
    heights = read_map(tmp_path / "a.tif")
    assert np.isnan(heights[3:5, 7:20]).all() and np.isnan(heights).sum() == 26
    known = np.isfinite(heights)
    np.testing.assert_array_equal(heights[known], values[known].astype(np.float32))


@pytest.mark.parametrize("orientation", range(1, 9))
def test_picture_and_its_mask_are_turned_upright(tmp_path: Path, orientation: int):
    values = np.zeros((2, 3), np.float32)
    values[0, 0] = 1
    shown = np.ones((2, 3), bool)
    shown[0, 0] = False
    corner = [None, (0, 0), (0, -1), (-1, -1), (-1, 0), (0, 0), (0, -1), (-1, -1), (-1, 0)][orientation]
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        file.write(values, metadata=None, extratags=[(274, "H", 1, orientation, True)])
        file.write(shown, subfiletype=4, photometric="minisblack", metadata=None)
    heights = read_map(tmp_path / "a.tif")
    assert heights.shape == ((3, 2) if orientation > 4 else (2, 3))
    assert np.isnan(heights[corner]) and np.isnan(heights).sum() == 1
