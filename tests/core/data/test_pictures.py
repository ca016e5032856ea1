"""If one of these fails, a picture is felt with other numbers than it has, or a hostile file is not refused."""

import io
import os
import struct
import zlib
from itertools import product

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

from hostile import SIDE, npy_header, npz_bomb, tiff
from tangible_core.data import Views, digest_of
from tangible_core.data.pictures import fill_non_finite, full_scale, to_grey, to_rgb8
from tangible_core.errors import PictureError, shown
from tangible_core.scene.formats import bands, decoding, reducing
from tangible_core.scene.formats import tiff as tiff_format
from tangible_core.scene.formats.pictures import MAX_LABELS, read_labels, read_map, read_picture

NAN = np.nan
COLOURS = np.random.default_rng(0).integers(0, 256, (6, 9, 3), dtype=np.uint8)


def encode(image, form, **options):
    file = io.BytesIO()
    image.save(file, form, **options)
    return file.getvalue()


def put(folder, name, data):
    path = folder / name
    path.write_bytes(data)
    return path


def save_npy(folder, name, array):
    np.save(folder / name, array)
    return folder / name


def save_by_opencv(folder, name, array):
    import cv2

    return put(folder, name, cv2.imencode(f".{name.rsplit('.')[-1]}", array)[1].tobytes())


def test_full_scale_is_the_maximum_of_the_type_or_of_a_float_picture():
    floats = [(np.float32(0.5), 1), (np.float64(4), 4), (np.float32(40), 255)]
    for white, scale in [(np.uint8(255), 255), (np.uint16(65535), 65535), (np.bool_(1), 1), *floats]:
        assert full_scale(np.full((2, 2), white)) == scale


@pytest.mark.parametrize(
    ("dtype", "white"),
    [(np.int16, 255)] + [(each, 65535) for each in (np.int32, np.uint32, np.int64, np.uint64, np.float32, np.float64)],
)
def test_picture_of_other_numbers_is_that_of_8_or_16_bits(dtype: type, white: int):
    plain = np.array([[0, 17, white // 5, white]], np.min_scalar_type(white))
    other = Views(plain.astype(dtype)).left
    np.testing.assert_allclose(to_grey(other), to_grey(plain), atol=1e-6)
    assert not other.flags.writeable
    assert other.dtype == (dtype if np.dtype(dtype).kind == "f" else plain.dtype)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64])
def test_grey_of_three_equal_channels_is_exactly_that_value(dtype):
    white = 1 if np.dtype(dtype).kind == "f" else np.iinfo(dtype).max
    one = (np.random.default_rng(1).random((211, 127)) * white).astype(dtype)
    for many in (np.dstack([one] * 3), np.dstack([one] * 3 + [np.full_like(one, white)])):
        assert digest_of(to_grey(many)) == digest_of(to_grey(one))
        assert digest_of(to_grey(many[::-1, ::3])) == digest_of(to_grey(one[::-1, ::3]))  # a BLAS asks how rows lie


def test_grey_equals_its_formula_with_white_where_transparent():
    red, green, blue, opaque = np.moveaxis(np.random.default_rng(2).random((64, 63, 4), np.float32), 2, 0)
    grey = green + np.float32(0.299) * (red - green) + np.float32(0.114) * (blue - green)
    assert digest_of(to_grey(np.dstack([red, green, blue]))) == digest_of(grey)
    assert digest_of(to_grey(np.dstack([red, green, blue, opaque]))) == digest_of(grey * opaque + (1 - opaque))
    picture = np.uint8([[[255, 0, 0, 0], [0, 0, 0, 255]]])
    np.testing.assert_allclose(to_grey(picture), [[1, 0]], atol=1e-6)
    assert to_rgb8(picture).tolist() == [[[255, 255, 255], [0, 0, 0]]]
    assert to_rgb8(COLOURS) is COLOURS
    assert to_rgb8(COLOURS.astype(np.uint16) * 257).tolist() == COLOURS.tolist()
    assert to_rgb8(np.array([[True, False]])).tolist() == [[[255] * 3, [0] * 3]]
    assert to_rgb8(np.float32([[-1, 0.5, 1]]))[..., 0].tolist() == [[0, 128, 255]]


@pytest.mark.parametrize("form", ["PNG", "TIFF", "BMP", "PPM", "GIF"])
def test_lossless_picture_file_is_read_unchanged(tmp_path, form):
    flat = COLOURS // 64 * 64
    path = put(tmp_path, "picture", encode(Image.fromarray(flat), form))
    np.testing.assert_array_equal(read_picture(path), flat)


def test_palette_png_becomes_rgb_or_rgba(tmp_path):
    image = Image.fromarray(np.uint8([[0, 1]]), "L").convert("P")
    image.putpalette([255, 0, 0, 0, 255, 0])
    assert read_picture(put(tmp_path, "a.png", encode(image, "PNG"))).tolist() == [[[255, 0, 0], [0, 255, 0]]]
    clear = put(tmp_path, "b.png", encode(image, "PNG", transparency=1))
    assert read_picture(clear).tolist() == [[[255, 0, 0, 255], [0, 255, 0, 0]]]


@pytest.mark.parametrize(("mode", "channels"), [("1", ()), ("L", ()), ("LA", (4,)), ("RGBA", (4,)), ("RGB", (3,))])
def test_picture_file_of_any_mode_becomes_grey_rgb_or_rgba(tmp_path, mode, channels):
    picture = read_picture(put(tmp_path, "a.png", encode(Image.new(mode, (5, 3), 1), "PNG")))
    assert picture.shape == (3, 5, *channels)
    assert picture.dtype == np.uint8


@pytest.mark.parametrize(("name", "channels"), [*product(["a.png", "a.tif"], [1, 3, 4]), ("a.pgm", 1)])
def test_sixteen_bit_file_keeps_its_values(tmp_path, name, channels):
    deep = np.random.default_rng(0).integers(0, 65536, (4, 5, channels), dtype=np.uint16).squeeze()
    swapped = deep if channels == 1 else deep[..., [2, 1, 0, 3][:channels]]
    picture = read_picture(save_by_opencv(tmp_path, name, swapped))
    np.testing.assert_array_equal(picture, deep, strict=True)


def refusal(path, read=read_picture):
    with pytest.raises(PictureError) as caught:
        read(path)
    message = str(caught.value)
    assert message.startswith(shown(f"{path}: ", 1000))
    assert message.isprintable()
    return message


@pytest.mark.parametrize("read", [read_picture, read_map, read_labels])
@pytest.mark.parametrize("name", ["left.png", "left.npy"])
def test_missing_picture_file_is_refused_with_a_similar_name(tmp_path, read, name):
    put(tmp_path, name.replace("left", "lefft"), b"x")
    assert f"no such file (did you mean 'lefft{name[4:]}'?)" in refusal(tmp_path / name, read)


@pytest.mark.parametrize("place", [".", os.devnull, "nowhere/a.png", "n" * 300, "a\0b"])
def test_place_without_a_file_is_refused(tmp_path, place):
    refusal(tmp_path / place)


@pytest.mark.parametrize(
    ("name", "data", "word"),
    [
        *((name, b"", "empty") for name in ("a.png", "a.npy", "a.npz")),
        *(("a.png", data, "use PNG") for data in (b"hello", b"%PDF-1.7 x", b"%!PS-Adobe-3.0 EPSF-3.0\n", b"\0" * 500)),
        ("a.pgm", b"P5 60000 60000 255\n", "89 megapixels"),
        ("a.pgm", b"P5 89200 1000 255\n", "89 megapixels"),  # Pillow's own limit is slightly higher
        ("a.pgm", b"P5 89000 1000 255\n", "cut short"),
    ],
)
def test_file_that_holds_no_picture_is_refused_with_the_reason(tmp_path, name, data, word):
    assert word in refusal(put(tmp_path, name, data))


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.webp", "deep.png"])
def test_truncated_picture_file_is_refused(tmp_path, name):
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    deep = noise.astype(np.uint16) * 257
    data = save_by_opencv(tmp_path, name, deep if name == "deep.png" else noise).read_bytes()
    assert "again" in refusal(put(tmp_path, name, data[: int(len(data) * 0.9)]))


@pytest.mark.parametrize(
    "layout",
    [
        {"bits": 64, "sample_format": 3},
        {"bits": 32, "samples": 3, "sample_format": 3},
        {"bits": 16, "samples": 3, "sample_format": 1},
        {"bits": 8, "sample_format": 1},
    ],
)
def test_tiff_announcing_too_many_pixels_is_refused_before_any_decoder(tmp_path, layout, monkeypatch):
    tiny = tiff(tmp_path / "tiny.tif", 5, 3, strip_rows=3, **layout)
    assert read_picture(tiny).shape[:2] == (3, 5)
    monkeypatch.setattr("tifffile.TiffPage.asarray", None)
    for name, width, height in (("a.tif", SIDE, SIDE), ("b.tif", 8_900, 10_001)):
        path = tiff(tmp_path / name, width, height, strip_rows=1, **layout)
        assert "larger than 89 megapixels; make it smaller first" in refusal(path)


@pytest.mark.parametrize("tag", [256, 257, 322, 323])
@pytest.mark.parametrize("last", [False, True])
def test_tiff_with_a_size_given_twice_is_refused_or_small(tmp_path, tag, last):
    """Tags 322 and 323 give the size of tiles, which are decoded whole."""
    twice = ((tag, 90_000_000), (tag, 5))
    path = tiff(tmp_path / "a.tif", 5, 3, strip_rows=3, more=twice[:: -1 if last else 1])
    try:
        assert read_picture(path).size <= 25
    except PictureError as error:
        assert "larger than 89 megapixels" in str(error) or "damaged" in str(error)


def test_tiff_with_too_large_tiles_is_refused(tmp_path):
    """A tile of 40,000 x 40,000 for a picture of 5 x 3 expands 1.6 MB to 1.6 GB."""
    path = tiff(tmp_path / "a.tif", 5, 3, bits=8, sample_format=1, more=((322, 40_000), (323, 40_000)))
    assert "larger than 89 megapixels" in refusal(path)


@pytest.mark.parametrize(("order", "side"), [("<", 3), ("<", 9_500), (">", 9_500)])
def test_big_tiff_is_read_or_refused_by_its_size(tmp_path, order, side):
    """BigTIFF has numbers of eight bytes. Pillow reads only little-endian files."""
    tags = [
        (256, side), (257, side), (258, 8), (259, 1), (262, 1), (273, 232), (277, 1), (278, side), (279, 9), (339, 1),
    ]  # fmt: skip
    table = b"".join(struct.pack(f"{order}HHQQ", tag, 16, 1, value) for tag, value in tags)
    mark = b"II" if order == "<" else b"MM"
    data = mark + struct.pack(f"{order}HHHQQ", 43, 8, 0, 16, len(tags)) + table + bytes(8 + 9)
    path = put(tmp_path, "a.tif", data)
    if side == 3:
        assert read_picture(path).tolist() == [[0] * 3] * 3
    else:
        assert "larger than 89 megapixels" in refusal(path)


def test_tiff_with_damage_or_too_many_bytes_is_refused_in_silence(tmp_path, capfd, monkeypatch):
    whole = tiff(tmp_path / "a.tif", 50, 30).read_bytes()
    assert "damaged" in refusal(put(tmp_path, "a.tif", whole[:-20]))
    assert capfd.readouterr() == ("", "")
    monkeypatch.setattr("tifffile.TiffPage.asarray", None)
    path = tiff(tmp_path / "a.tif", 30_000, 2_000, strip_rows=1, bits=64, samples=4)
    assert "holds more than 1424 MB; make it smaller first" in refusal(path)


@pytest.mark.timeout(20)
@pytest.mark.parametrize("read", [read_picture, read_map, read_labels])
@pytest.mark.parametrize("name", ["a.npy", "a.png"])
def test_pipe_as_a_picture_is_refused_at_once(tmp_path, read, name):
    os.mkfifo(tmp_path / name)
    assert "not a file but a folder or a device" in refusal(tmp_path / name, read)


@pytest.mark.parametrize("read", [read_picture, read_map, read_labels])
def test_npy_file_announcing_too_much_is_refused(tmp_path, read):
    path = put(tmp_path, "a.npy", npy_header((10_000, 10_000)))
    assert "larger than 89 megapixels; make it smaller first" in refusal(path, read)
    path = npz_bomb(tmp_path / "a.npz", a=(13_000, 6_000, 4))
    assert "holds more than 1424 MB; make it smaller first" in refusal(path, read)


def test_map_file_keeps_its_raw_numbers_and_holes(tmp_path):
    values = np.array([[1.5, NAN], [np.inf, -np.inf]])
    for name, save in (("a.npy", np.save), ("a.npz", np.savez)):
        save(tmp_path / name, values)
        np.testing.assert_array_equal(read_map(tmp_path / name), np.float32([[1.5, NAN], [NAN, NAN]]))
    grey = np.repeat(np.arange(6, dtype=np.uint8).reshape(2, 3, 1), 3, axis=2)
    assert read_map(put(tmp_path, "a.png", encode(Image.fromarray(grey), "PNG"))).tolist() == [[0, 1, 2], [3, 4, 5]]
    assert np.isnan(read_map(save_npy(tmp_path, "a.npy", np.array([[1e300]])))).all()


@pytest.mark.parametrize(
    "values", [COLOURS, np.zeros((0, 3)), np.zeros(3), np.zeros((2, 2), complex), np.array([["a"]])]
)
def test_array_of_another_shape_or_type_as_a_map_is_refused(tmp_path, values):
    assert "a map must have one number per pixel" in refusal(save_npy(tmp_path, "a.npy", values), read_map)


def test_label_file_is_numbered_from_zero_by_value_index_or_colour(tmp_path):
    path = put(tmp_path, "a.png", encode(Image.fromarray(np.uint8([[7, 7], [200, 30]])), "PNG"))
    assert read_labels(path).dtype == np.int32
    assert read_labels(path).tolist() == [[0, 0], [2, 1]]
    image = Image.fromarray(np.uint8([[0, 1, 2]]), "L").convert("P")
    image.putpalette([255, 255, 255, 0, 0, 0, 128, 128, 128])
    assert read_labels(put(tmp_path, "a.png", encode(image, "PNG"))).tolist() == [[0, 1, 2]]
    flat = np.uint8([[[255, 0, 0], [0, 255, 0]], [[0, 255, 0], [255, 0, 0]]])
    labels = read_labels(put(tmp_path, "a.png", encode(Image.fromarray(flat), "PNG")))
    assert np.unique(labels).tolist() == [0, 1]
    assert labels[0, 0] == labels[1, 1] != labels[0, 1] == labels[1, 0]
    photo = np.arange(MAX_LABELS + 1, dtype=np.int32)[None]
    assert "give each segment one flat colour" in refusal(save_npy(tmp_path, "a.npy", photo), read_labels)


@pytest.mark.parametrize("values", [np.zeros((2, 2, 5), np.uint8), np.zeros((0, 2)), np.array([[NAN, 1]])])
def test_array_that_does_not_hold_labels_is_refused(tmp_path, values):
    refusal(save_npy(tmp_path, "a.npy", values), read_labels)


@pytest.mark.parametrize("channels", [(), (3,), (4,)])
def test_non_finite_pixels_are_filled_from_the_nearest_finite_one(channels):
    picture = np.random.default_rng(0).random((6, 8, *channels))
    expected = picture.copy()
    picture[2, 3:] = np.nan
    picture[5, 0] = [np.inf, -np.inf, 0.5, 1][: channels[0]] if channels else np.inf
    filled, known = fill_non_finite(picture)
    assert np.argwhere(~known).tolist() == [*([2, column] for column in range(3, 8)), [5, 0]]
    assert np.array_equal(filled[known], expected[known])
    assert np.array_equal(filled[2, 6:], expected[1, 6:])
    assert np.array_equal(filled[5, 0], expected[4, 0])


def test_picture_without_finite_pixels_cannot_be_filled():
    with pytest.raises(PictureError, match="none of the 6 pixels is finite"):
        fill_non_finite(np.full((2, 3), np.nan))


def test_jpeg_that_is_too_large_is_reduced_while_it_is_read(tmp_path, monkeypatch):
    """A picture of 96 x 64 pixels where 2000 are the most: half of its sides have 1536."""
    monkeypatch.setattr(reducing, "MAX_PIXELS", 2000)
    monkeypatch.setattr(reducing, "MAX_REDUCED", 20_000)
    grey = np.repeat(np.linspace(0, 255, 96).astype(np.uint8)[None], 64, axis=0)
    path = put(tmp_path, "wide.jpg", encode(Image.fromarray(grey), "JPEG", quality=95))
    said = []
    reduced = read_picture(path, notify=said.append, reduce=True)
    assert reduced.shape == (32, 48)
    np.testing.assert_allclose(reduced, grey[::2, ::2], atol=6)
    assert said == ["wide.jpg has 0 megapixels; it is reduced to 48 x 32 pixels while it is read"]
    assert read_picture(path).shape == (64, 96), "labels, truths and pairs keep their pixels"
    monkeypatch.setattr(reducing, "MAX_REDUCED", 4000)
    assert read_picture(path, reduce=True).shape == (64, 96)


SMOOTH = np.add.outer(np.arange(61), np.arange(97))[..., None] + [0, 40, 90] + COLOURS[:1, :1] % 7
LARGE = (SMOOTH + np.random.default_rng(1).integers(0, 9, SMOOTH.shape)).astype(np.uint8)
"""A picture of 97 x 61 pixels: where 1600 are the most, a half of its sides, rounded up, has 49 x 31."""


def png(mode, **options):
    return lambda path: Image.fromarray(LARGE).convert(mode).save(path, "PNG", **options)


def deep(suffix, channels):
    pixels = np.ascontiguousarray(LARGE[..., :channels].astype(np.uint16) * 211)
    return lambda path: path.write_bytes(cv2.imencode(suffix, pixels)[1].tobytes())


def strips(compression, mode="RGB", **options):
    return lambda path: Image.fromarray(LARGE).convert(mode).save(path, "TIFF", compression=compression, **options)


def by_tifffile(pixels=LARGE, **options):
    return lambda path: tifffile.imwrite(path, pixels, metadata=None, **options)


REDUCED = {
    "L.png": png("L"),
    "RGB.png": png("RGB"),
    "RGBA.png": png("RGBA"),
    "P with 4 bits.png": png("P", bits=4),
    "1.png": png("1"),
    "L 16.png": deep(".png", 1),
    "RGB 16.png": deep(".png", 3),
    "turned.png": png("RGB", exif=b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"),
    "one strip.tif": by_tifffile(),
    "lzw.tif": strips("tiff_lzw", strip_size=97 * 3 * 5),
    "deflate.tif": strips("tiff_adobe_deflate", strip_size=97 * 3 * 5),
    "fax.tif": strips("group4", "1", strip_size=13 * 5),
    "jpeg.tif": strips("jpeg", strip_size=97 * 3 * 16),
    "turned.tif": strips("tiff_lzw", strip_size=97 * 3 * 5, tiffinfo={274: 8}),
    "tiles.tif": by_tifffile(tile=(16, 32), compression="zlib", predictor=2),
    "planes.tif": by_tifffile(np.moveaxis(LARGE, 2, 0), planarconfig="separate", photometric="rgb"),
    "RGB 16.tif": by_tifffile(LARGE.astype(np.uint16) * 211, rowsperstrip=7, compression="zlib"),
    "float.tif": by_tifffile(LARGE[..., 0].astype(np.float32) / 255, rowsperstrip=7),
    "big-endian.tif": by_tifffile(byteorder=">", rowsperstrip=4),
    "big.tif": by_tifffile(bigtiff=True, rowsperstrip=4),
}


@pytest.mark.parametrize("name", REDUCED)
def test_png_and_tiff_that_are_too_large_are_reduced_while_they_are_read(tmp_path, monkeypatch, name):
    path = tmp_path / name
    REDUCED[name](path)
    whole = read_picture(path)
    monkeypatch.setattr(bands, "BAND_PIXELS", 600)
    monkeypatch.setattr(reducing, "MAX_PIXELS", 1600)
    monkeypatch.setattr(reducing, "MAX_REDUCED", 20_000)
    said = []
    picture = read_picture(path, notify=said.append, reduce=True)
    turn = {"turned.png": 6, "turned.tif": 8}.get(name, 1)
    stored = decoding.upright(whole, {1: 1, 6: 8, 8: 6}[turn]).astype(float)
    assert stored.shape[:2] == (61, 97)
    even = np.pad(stored, [(0, 1), (0, 1)] + [(0, 0)] * (stored.ndim - 2), mode="edge")
    mean = (even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2]) / 4
    expected = decoding.upright(mean, turn)
    assert picture.dtype == whole.dtype
    np.testing.assert_allclose(picture, expected, atol=1 if whole.dtype.kind == "u" else 1e-6)
    assert said == [f"{name} has 0 megapixels; it is reduced to 49 x 31 pixels while it is read"]


def png_file(*chunks):
    """Return a PNG of these chunks, with their check sums."""
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )


def png_of(row_filter, interlaced=0):
    """Return a grey PNG of 97 x 61 pixels of noise, each of whose rows has this filter."""
    noise = np.random.default_rng(0).integers(0, 256, (61, 98), dtype=np.uint8)
    noise[:, 0] = row_filter
    header = struct.pack(">IIBBBBB", 97, 61, 8, 0, 0, 0, interlaced)
    return png_file((b"IHDR", header), (b"IDAT", zlib.compress(noise.tobytes())), (b"IEND", b""))


def test_png_with_two_different_headers_is_refused(tmp_path):
    """OpenCV reads the first header, with 4e8 pixels; Pillow the second, with one."""
    headers = [(b"IHDR", struct.pack(">IIBBBBB", side, side, 16, 2, 0, 0, 0)) for side in (20_000, 1)]
    data = png_file(*headers, (b"IDAT", zlib.compress(bytes(7))), (b"IEND", b""))
    assert "larger than 89 megapixels" in refusal(put(tmp_path, "a.png", data))


@pytest.mark.parametrize(
    ("name", "write", "word"),
    [
        ("a.tif", strips("tiff_lzw", strip_size=1 << 20), "strips"),
        ("a.png", lambda path: path.write_bytes(png_of(6, interlaced=1)), "interlacing"),
        ("a.png", lambda path: path.write_bytes(png_of(9)), "unknown filter"),
        ("a.png", lambda path: path.write_bytes(png_of(3)[:-40]), "rows end early"),
    ],
)
def test_large_picture_that_cannot_be_cut_into_bands_is_refused(tmp_path, monkeypatch, name, write, word):
    write(tmp_path / name)
    monkeypatch.setattr(bands, "BAND_PIXELS", 600)
    monkeypatch.setattr(tiff_format, "MAX_PIXELS", 1600)
    monkeypatch.setattr(reducing, "MAX_PIXELS", 1600)
    with pytest.raises(PictureError, match=word):
        read_picture(tmp_path / name, reduce=True)
