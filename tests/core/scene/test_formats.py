"""If one of these fails, a file that people have is felt with other numbers than those it holds."""

import shutil
import struct
import sys
import zlib
from itertools import product
from pathlib import Path

import imagecodecs
import numpy as np
import pillow_heif
import pytest
import tifffile
from PIL import Image

from tangible_core import Scene
from tangible_core.errors import PictureError
from tangible_core.scene.formats.kinds import file_kind
from tangible_core.scene.formats.pictures import read_labels, read_map, read_picture

CHANCE = np.random.default_rng(0)
GREY = CHANCE.integers(0, 200, (9, 14)).astype(np.uint8)
HEIGHTS = np.array([[1.5, -2.25, -9999], [0, 100, 7]])


def put(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


def png(path: Path, bits: int, colour: int, row: bytes, columns: int, clear: bytes) -> Path:
    """Write a PNG of one row. Source: PNG, third edition, sections 11.2 and 11.3."""
    header = struct.pack(">IIBBBBB", columns, 1, bits, colour, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"tRNS", clear), (b"IDAT", zlib.compress(b"\0" + row)), (b"IEND", b"")]
    packed = (
        struct.pack(">I", len(c)) + n + c + struct.pack(">I", zlib.crc32(n + c)) for n, c in chunks if c or n != b"tRNS"
    )
    return put(path, b"\x89PNG\r\n\x1a\n" + b"".join(packed))


class TestNetpbm:
    @pytest.mark.parametrize("white", [1, 64, 255, 256, 1000, 65535])
    @pytest.mark.parametrize("form", ["P2", "P5"])
    def test_map_has_the_numbers_and_a_picture_reaches_white(self, tmp_path: Path, white: int, form: str):
        values = np.array([[0, white // 2, white]])
        digits = " ".join(map(str, values[0])).encode()
        stored = values.astype("u1" if white < 256 else ">u2").tobytes() if form == "P5" else digits
        path = put(tmp_path / "a.pgm", f"{form} # a remark\n3 1\n{white}\n".encode() + stored)
        np.testing.assert_array_equal(read_map(path), values)
        full = 255 if white < 256 else 65535
        np.testing.assert_array_equal(read_picture(path), np.floor(values * full / white + 0.5))

    @pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
    @pytest.mark.parametrize("order", ["<", ">"])
    def test_pfm_has_the_numbers_with_any_line_end(self, tmp_path: Path, end: str, order: str):
        values = np.array([[1.5, 10.0], [-3, 0.25]], np.float32)
        head = end.join(["Pf", "2 2", "-1.0" if order == "<" else "1.0", ""]).encode()
        path = put(tmp_path / "a.pfm", head + values[::-1].astype(f"{order}f4").tobytes())
        np.testing.assert_array_equal(read_map(path), values)


class TestPng:
    def test_transparent_values_of_sixteen_bits_are_unknown_or_transparent(self, tmp_path: Path):
        path = png(tmp_path / "a.png", 16, 0, struct.pack(">3H", 0, 500, 600), 3, struct.pack(">H", 0))
        np.testing.assert_array_equal(read_map(path), [[np.nan, 500, 600]])
        assert read_picture(path)[0, :, 3].tolist() == [0, 65535, 65535]
        row = struct.pack(">6H", 1, 2, 3, 256, 512, 768)
        path = png(tmp_path / "a.png", 16, 2, row, 2, struct.pack(">3H", 1, 2, 3))
        assert read_picture(path)[0].tolist() == [[1, 2, 3, 0], [256, 512, 768, 65535]]

    @pytest.mark.parametrize(("bits", "row"), [(1, 0b01100000), (2, 0b00011011), (4, 0)])
    def test_few_bits_are_numbers_in_a_map(self, tmp_path: Path, bits: int, row: int):
        values = [row >> (8 - bits - bits * i) & ((1 << bits) - 1) for i in range(8 // bits)]
        path = png(tmp_path / "a.png", bits, 0, bytes([row]), 8 // bits, b"")
        assert read_map(path)[0].tolist() == values


@pytest.mark.parametrize(("bits", "dtype"), [(8, "uint8"), (12, "uint16"), (16, "uint16")])
def test_jpeg_2000_of_any_depth_is_a_map_of_its_numbers(tmp_path: Path, bits: int, dtype: str):
    values = CHANCE.integers(0, 1 << bits, (40, 50)).astype(dtype)
    path = put(tmp_path / "a.jp2", imagecodecs.jpeg2k_encode(values, level=0, bitspersample=bits))
    np.testing.assert_array_equal(read_map(path), values)
    white = 255 if bits == 8 else 65535
    np.testing.assert_array_equal(read_picture(path), np.floor(values * (white / ((1 << bits) - 1)) + 0.5))


@pytest.mark.parametrize("form", ["AVIF", "HEIF"])
def test_pictures_of_phones_are_read(tmp_path: Path, form: str):
    values = np.kron(CHANCE.integers(0, 256, (4, 5, 3)), np.ones((16, 16, 1))).astype(np.uint8)
    path = tmp_path / "IMG_1"
    if form == "AVIF":
        Image.fromarray(values).save(path, "AVIF", quality=100)
    else:
        pillow_heif.from_pillow(Image.fromarray(values)).save(path, quality=100)
    assert file_kind(path) == "picture"
    np.testing.assert_allclose(read_picture(path)[8::16, 8::16], values[8::16, 8::16], atol=12)


class TestGrids:
    def test_grids_and_srtm_tiles_are_maps_without_their_value_for_no_data(self, tmp_path: Path):
        head = "NCOLS 3\r\nnrows 2\r\nxllcorner 7.5\r\nyllcorner 46\r\ncellsize 25\r\nNODATA_value -9999\r\n"
        rows = "\r\n".join(" ".join(map(str, row)) for row in HEIGHTS)
        path = put(tmp_path / "dem", (head + rows + "\r\n").encode())
        assert file_kind(path) == "heights"
        np.testing.assert_array_equal(read_map(path), np.where(HEIGHTS == -9999, np.nan, HEIGHTS))
        values = CHANCE.integers(-100, 4000, (1201, 1201)).astype(">i2")
        values[3, 5] = -32768
        heights = read_map(put(tmp_path / "N46E007.hgt", values.tobytes()))
        assert np.argwhere(np.isnan(heights)).tolist() == [[3, 5]]
        assert heights[0, 0] == values[0, 0] and heights[-1, -1] == values[-1, -1]
        with pytest.raises(PictureError, match="damaged or cut short"):
            read_map(put(tmp_path / "N46E008.hgt", values.tobytes()[:-10]))

    @pytest.mark.parametrize(("order", "byteorder"), [("<", "I"), (">", "M")])
    def test_bil_and_flt_are_read_by_their_header(self, tmp_path: Path, order: str, byteorder: str):
        head = f"BYTEORDER {byteorder}\nNROWS 2\nNCOLS 3\nNBANDS 1\nNODATA -9999\n"
        put(tmp_path / "a.hdr", (head + "NBITS 16\nPIXELTYPE SIGNEDINT").encode())
        integers = read_map(put(tmp_path / "a.bil", HEIGHTS.astype(f"{order}i2").tobytes()))
        np.testing.assert_array_equal(integers, np.where(HEIGHTS == -9999, np.nan, np.trunc(HEIGHTS)))
        shutil.copy(tmp_path / "a.hdr", tmp_path / "b.hdr")
        floats = read_map(put(tmp_path / "b.flt", HEIGHTS.astype(f"{order}f4").tobytes()))
        np.testing.assert_array_equal(floats, np.where(HEIGHTS == -9999, np.nan, HEIGHTS))


class TestKinds:
    @pytest.mark.parametrize("name", ["a", "a.jfif", "a.jpe", "a.JPG", "a.dat", "a.png"])
    def test_picture_is_one_by_its_first_bytes(self, tmp_path: Path, name: str):
        Image.fromarray(GREY).save(tmp_path / name, "JPEG")
        assert file_kind(tmp_path / name) == "picture"
        assert read_picture(tmp_path / name).shape == GREY.shape

    @pytest.mark.parametrize(
        ("values", "tags", "kind"),
        [
            (GREY, [], "picture"),
            (GREY.astype(np.uint16), [], "picture"),
            (GREY.astype(np.float32), [], "heights"),
            (GREY.astype(np.int16), [], "heights"),
            (GREY.astype(np.uint16), [(34735, "H", 4, (1, 1, 0, 0), True)], "heights"),
            (np.dstack([GREY] * 3), [(34735, "H", 4, (1, 1, 0, 0), True)], "picture"),
        ],
    )
    def test_tiff_of_heights_is_told_from_a_picture(self, tmp_path: Path, values: np.ndarray, tags: list, kind: str):
        tifffile.imwrite(tmp_path / "a.tif", values, extratags=tags)
        assert file_kind(tmp_path / "a.tif") == kind

    @pytest.mark.parametrize(
        ("head", "kind"),
        [
            (b"\0\0\0\x18ftypmp42", "video"), (b"RIFF\0\0\0\0AVI LIST", "video"), (b"\x1aE\xdf\xa3", "video"),
            (b"RIFF\0\0\0\0WEBPVP8 ", "picture"), (b"Pf\n2 2\n", "heights"), (b"\x93NUMPY", "heights"),
            (b"scene: {photo: a.png}\n", None), (b"", None), (b"%PDF-1.4\n", "picture"), (b"<html><svg/>", None),
            (b'\xef\xbb\xbf<?xml version="1.0"?>\n<!-- <a> -->\n<!DOCTYPE svg "x">\n<s:svg>', "picture"),
            (b"<!---->" * 140, None),  # tried in both ways each, it would take for ever
        ],
    )  # fmt: skip
    def test_first_bytes_tell_what_a_file_is(self, tmp_path: Path, head: bytes, kind: str | None):
        assert file_kind(put(tmp_path / "a", head)) == kind


@pytest.mark.parametrize(("representation", "near_is_light"), [(1, True), (2, False)])
def test_depth_of_a_phones_heic_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, representation: int, near_is_light: bool
):
    """No encoder writes depth into a HEIC, so that what the library gives is replaced here."""
    depth = np.linspace(0, 255, 48 * 64).reshape(48, 64).astype(np.uint8)
    path = tmp_path / "IMG_1.HEIC"
    pillow_heif.from_pillow(Image.fromarray(np.zeros((96, 128, 3), np.uint8))).save(path)
    found = pillow_heif.open_heif(path)
    image = Image.fromarray(depth)
    image.info["metadata"] = {"representation_type": representation}
    image.to_pillow = lambda: image  # type: ignore[attr-defined]
    found.info["depth_images"] = [image]
    monkeypatch.setattr(pillow_heif, "open_heif", lambda *_, **__: found)
    scene = Scene.photo(path)
    assert scene.disparity is not None
    near = scene.disparity.disparity_px
    assert near.shape == (96, 128) and (near[-1, -1] > near[0, 0]) == near_is_light
    assert scene.notes == (
        "IMG_1.HEIC holds a depth map of 64 x 48 (HEIC), which is used; `photo_depth: false` leaves it out",
    )


def test_heic_without_its_extra_names_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "a.heic"
    pillow_heif.from_pillow(Image.fromarray(np.zeros((96, 128, 3), np.uint8))).save(path)
    monkeypatch.setitem(sys.modules, "pillow_heif", None)
    with pytest.raises(PictureError, match=r"is a HEIC picture; `pip install 'tangible-images\[heic\]'` reads these"):
        read_picture(path)


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
