"""The readers of files that people bring, with small valid files for each."""

import json
import os
import shutil
import struct
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import asdict
from functools import cache
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any
from unittest.mock import patch

import cv2
import imagecodecs
import numpy as np
import pillow_heif
import tifffile
from PIL import Image, TiffImagePlugin

import onnx_models
import phone_photos
import standard_sets
import studies
from mutated import Damage, Reader
from pictures import write_png
from videos import grey, jpegs, write_video

ROOT = Path(__file__).parents[2]
CHANCE = np.random.default_rng(0)
COLOURS = CHANCE.integers(0, 256, (12, 16, 3), np.uint8)
GREY = COLOURS[..., 0]
DEEP = CHANCE.integers(0, 65536, (12, 16), np.uint16)
MAP = CHANCE.random((12, 16)).astype(np.float32)
LABELS = np.arange(192, dtype=np.uint8).reshape(12, 16) // 48


def _image(name: str, picture: np.ndarray, **options: Any) -> Callable[[Path], object]:
    return lambda folder: Image.fromarray(picture).save(folder / name, **options)


def _all(*makers: Callable[[Path], object]) -> Callable[[Path], object]:
    return lambda folder: [make(folder) for make in makers]


def _bytes(name: str, data: bytes | str) -> Callable[[Path], object]:
    return lambda folder: (folder / name).write_bytes(data.encode() if isinstance(data, str) else data)


def _several(name: str, **options: Any) -> Callable[[Path], object]:
    pages = [Image.fromarray(each) for each in (COLOURS[:, ::-1], COLOURS // 2)]
    return _image(name, COLOURS, save_all=True, append_images=pages, **options)


def _palette(name: str) -> Callable[[Path], object]:
    return lambda folder: Image.fromarray(COLOURS).convert("P", palette=Image.Palette.ADAPTIVE).save(folder / name)


def _by_opencv(name: str, picture: np.ndarray) -> Callable[[Path], object]:
    return lambda folder: (folder / name).write_bytes(cv2.imencode(Path(name).suffix, picture)[1].tobytes())


def _geotiff(folder: Path) -> None:
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    tags[42113] = "-9999"
    Image.fromarray(MAP).save(folder / "dem.tif", tiffinfo=tags)


def _tiff(name: str, values: np.ndarray, **options: Any) -> Callable[[Path], object]:
    return lambda folder: tifffile.imwrite(folder / name, values, **options)


def _npz(folder: Path) -> None:
    np.savez(folder / "stored.npz", MAP)
    np.savez_compressed(folder / "packed.npz", depth=MAP)


def _npy(folder: Path) -> None:
    np.save(folder / "map.npy", MAP)
    np.save(folder / "columns.npy", np.asfortranarray(COLOURS))


def _pfm(folder: Path) -> None:
    standard_sets.put_pfm(folder / "little.pfm", MAP)
    standard_sets.put_pfm(folder / "big.pfm", MAP, ">")


def _reader(module: str, function: str, **options: Any) -> Callable[[Path], object]:
    """Return the reader of that name, whose module is imported when a file is read."""
    return lambda path: getattr(import_module(module), function)(path, **options)


_picture = _reader("tangible_core.scene.formats.pictures", "read_picture", reduce=True)
_map = _reader("tangible_core.scene.formats.pictures", "read_map")


def _truth(path: Path) -> object:
    from tangible_core.scene.formats.pictures import read_truth

    return read_truth(path, "sintel" if "sintel" in path.name else 256.0)


def _photo(path: Path) -> object:
    from tangible_core import Scene

    return Scene.photo(path)


def _large(path: Path) -> object:
    """Read as if a picture of more than a hundred pixels were too large to be held."""
    from tangible_core.scene.formats import reducing

    with patch.object(reducing, "MAX_PIXELS", 100):
        return _picture(path)


def _make_jps(folder: Path) -> None:
    data = phone_photos.jpeg(np.hstack([COLOURS, COLOURS]))
    state = phone_photos.segment(b"_JPSJPS_\0\4\0\4\2\1\0\0", 0xE3)
    (folder / "pair.jps").write_bytes(data[:2] + state + data[2:])


def _make_phone(folder: Path) -> None:
    for write in (phone_photos.gdepth, phone_photos.dynamic, phone_photos.iphone):
        (folder / f"{write.__name__}.jpg").write_bytes(write(phone_photos.jpeg(phone_photos.RAMP)))


def _make_rigs(folder: Path) -> None:
    (folder / "camchain.yaml").write_text(KALIBR)
    (folder / "calib.txt").write_text(standard_sets.CALIB)
    (folder / "000000.txt").write_text(KITTI)
    for side, shift in (("left", 0), ("right", -11)):
        (folder / f"{side}.yaml").write_text(
            "image_width: 16\nimage_height: 12\nK: [110, 0, 60, 0, 113, 44, 0, 0, 1]\nD: [0.1, 0.01, 0, 0, 0]\n"
            f"R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nP: [110, 0, 60, {shift}, 0, 110, 44, 0, 0, 0, 1, 0]\n"
        )
    camera = np.array([[110.0, 0, 60], [0, 113, 44], [0, 0, 1]])
    for suffix in ("yml", "xml"):
        storage = cv2.FileStorage(str(folder / f"rig.{suffix}"), cv2.FILE_STORAGE_WRITE)
        for name, value in {
            "M1": camera, "D1": np.array([[0.1, 0.01, 0, 0]]), "M2": camera, "D2": np.zeros((1, 5)), "R": np.eye(3),
            "T": np.array([[-0.1], [0], [0]]),
        }.items():  # fmt: skip
            storage.write(name, value)
        storage.release()


KALIBR = """\
cam0:
  camera_model: pinhole
  intrinsics: [110.0, 113.0, 60.0, 44.0]
  distortion_model: radtan
  distortion_coeffs: [0.1, 0.01, 0.0, 0.0]
  resolution: [16, 12]
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.01]
  - [0.0, 0.0, 1.0, 0.005]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  intrinsics: [115.0, 118.0, 60.0, 44.0]
  distortion_model: equidistant
  distortion_coeffs: [0.01, 0.0, 0.0, 0.0]
  resolution: [16, 12]
"""


def _rig(path: Path) -> object:
    from tangible_core.data import Views
    from tangible_core.scene.formats.rigs import read_rig
    from tangible_core.scene.rig import rectify_views

    cameras, size = read_rig(path, 0.5)
    return rectify_views(Views(COLOURS, COLOURS), cameras), size


def _make_heights(folder: Path) -> None:
    from tangible_core.data import Relief
    from tangible_core.scene.formats.height_maps import HeightsMetadata, levels

    numbers, low_mm, step_mm = levels(Relief(MAP * np.float32(0.01), (0.16, 0.12)))
    metadata = HeightsMetadata(
        file="map.png", columns=16, rows=12, width_mm=160, length_mm=120, high_mm=10, low_mm=low_mm, step_mm=step_mm
    )
    (folder / "map.json").write_text(metadata.model_dump_json())
    Image.fromarray(numbers).save(folder / "map.png")
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    own = {"file": "own.tif", "step_mm": 1.0, "low_mm": 0.0, "high_mm": float(MAP.max())}
    tags[270] = metadata.model_copy(update=own).model_dump_json()
    Image.fromarray(MAP).save(folder / "own.tif", tiffinfo=tags)


def _make_ground(folder: Path) -> None:
    import tifffile

    keys = (34735, "H", 8, [1, 1, 0, 1, 1024, 0, 1, 2], True)
    place = (33922, "d", 6, (0.0, 0.0, 0.0, 10.0, 60.0, 0.0), True)
    for name, order in (("a.tif", "<"), ("b.tif", ">")):
        tags = [(33550, "d", 3, (0.01, 0.02, 0.0), True), place, keys]
        tifffile.imwrite(folder / name, MAP, byteorder=order, extratags=tags)
    matrix = (0.0, 10, 0, 1000, -5, 0, 0, 2000, 0, 0, 0, 0, 0, 0, 0, 1)
    tifffile.imwrite(folder / "c.tif", MAP, extratags=[(34264, "d", 16, matrix, True)])
    (folder / "d.asc").write_text("ncols 3\nnrows 2\nxllcorner 10\nyllcorner 60\ncellsize 0.001\n1 2 3\n4 5 6\n")


def _heights(path: Path) -> object:
    from tangible_core import Scene

    scene = Scene.heights(path)
    return scene.height, scene.brings(0.08, 0.02)


def _make_pipelines(folder: Path) -> None:
    write_png(folder / "photo.png", COLOURS)
    np.save(folder / "map.npy", MAP)
    Image.fromarray(LABELS).save(folder / "labels.png")
    (folder / "full.yaml").write_text(PIPELINE)
    (folder / "parts.yaml").write_text(PARTS)
    for path in (ROOT / "configs/feel.yaml", ROOT / "configs/relief.yaml"):
        shutil.copy(path, folder)


PIPELINE = """\
scene: {photo: photo.png, disparity: map.npy, segments: labels.png}
want: touch
workspace: {width_m: 0.1, relief_m: 0.01}
relief: {by: disparity, slope: 1.5, accent_m: 0.0005}
depth: {use: luminance, smoothing_px: 1}
texture: {use: histogram, segments: 3}
materials: {1: ice, 2: rubber, 3: wood}
render: {use: proxy, stiffness_n_per_m: 500}
device: {use: mock, path: circle}
safety: {max_force_n: 2.5}
export: [{use: heights}, {use: stl, base_m: 0.002}]
"""
PARTS = """\
scene: {photo: photo.png, segments: labels.png}
want: surface
heights: {by: given, round_m: 6 mm, bulge_m: 1.5 mm}
parts:
  1: wall             # behind
  2: {name: helmet, height_m: 0.004}
  3: {name: face, material: rubber}
simplify: {}
"""


def _pipeline(path: Path) -> object:
    from tangible_core import load_pipeline

    return load_pipeline(path).plan()


def _edits(path: Path) -> object:
    """What the page and `tangible new` do with a pipeline file: changes of single keys, and of parts."""
    from tangible_core.files.yaml.parts_block import with_parts
    from tangible_core.files.yaml.source import read_text
    from tangible_core.pipeline.config.editing import with_overrides

    text = read_text(path)
    return with_overrides(text, path, ["render.stiffness_n_per_m=300"]), with_parts(text, path, {1: "sky"})


MATERIALS = """\
ice: {stiffness_n_per_m: 900, source: guess}
felt:
  stiffness_n_per_m: 300
  damping_n_s_per_m: 0.2
  static_friction: 0.6
  dynamic_friction: 0.5
  texture: periodic
  roughness_m: 0.0001
  grain_m: 0.002
  source: {static_friction: measured, others: guess}
"""


def _make_recordings(folder: Path) -> None:
    from tangible_core.data import TICK_COLUMNS
    from tangible_core.session.recording.recording import Recording
    from tangible_core.session.recording.tick_file import About

    rows = np.zeros((20, len(TICK_COLUMNS)))
    rows[:, 0] = np.arange(20) / 1000
    about = About(**{name: "{}" for name in ("parts", "materials") if name in About.__dataclass_fields__})
    for suffix in ("nc", "npz", "csv"):
        Recording(rows, "the hand left", about).save(folder / f"stroke.{suffix}")


def _recording(path: Path) -> object:
    from tangible_core.session.parts_felt import read_names
    from tangible_core.session.recording.recording import Recording

    recording = Recording.load(path)
    about = recording.about
    return [read_names(getattr(about, name, "")) for name in ("parts", "materials")]


STROKE = "time_s,x_m,y_m,z_m\n0,0,0,0.01\n0.1,0.01,0,0.01\n0.2,0.01,0.02,0\n"


def _stroke(path: Path) -> object:
    from tangible_devices.paths import read_csv

    return read_csv(path, 0.001).at(5)


def _make_run(folder: Path) -> None:
    from tangible_core.pipeline.output.result_folders import Manifest

    Manifest("../p.yaml", {"config.yaml": "0" * 32, "outcomes.json": "1" * 32}).write(folder)
    (folder / "outcomes.json").write_text(json.dumps({"outcomes": [{"product": "relief", "outcome": "ran"}]}))


def _run(path: Path) -> object:
    from tangible_core.pipeline.output.result_folders import _own, default_folder, read_manifest

    return read_manifest(path.parent), _own(path.parent), default_folder(path)


def _make_exports(folder: Path) -> None:
    from tangible_core.pipeline.output.result_folders import LISTED, Listed, _write_list

    _write_list(folder / LISTED, {"a.stl": Listed("p.yaml", "stl", "0" * 32)})


def _exports(path: Path) -> object:
    from tangible_core.pipeline.output.result_folders import read_list

    return [each == listed for each in read_list(path.parent).values() for listed in [each]]


def _make_results(folder: Path) -> None:
    from tangible_bench.measuring.rows import Row

    for number in range(2):
        row = Row(
            f"k{number}", "depth", "zncc", "zncc", {"window_px": 9}, "tangible_depth", "synthetic/planes", "d" * 16,
            "none", ("fill",), number, {"numpy": "2"}, {"cores": 2, "name": "x"}, "zncc", 0.1, 0.2, 1000,
            {"bad2": 3.0}, None,
        )  # fmt: skip
        with (folder / "rows.jsonl").open("a") as file:
            file.write(json.dumps(asdict(row)) + "\n")


def _results(path: Path) -> object:
    from tangible_bench import comparing

    with patch.object(comparing, "draw_plot", lambda *_: False):  # takes longer than all else
        return comparing.read_comparison(path)


def _make_comparisons(folder: Path) -> None:
    for path in (ROOT / "configs").glob("compare-*.yaml"):
        shutil.copy(path, folder)


def _comparison(path: Path) -> object:
    from tangible_bench.config.reading import load_comparison
    from tangible_core.plugins.registry import default_registry

    return load_comparison(path, default_registry())


def _study(path: Path) -> object:
    from tangible_study.study_file import load_study, read_design

    read_design(path)
    return load_study(path)


def _make_answers(folder: Path) -> None:
    from tangible_study.trials import Answer, AnswerFile

    studies.write_study(folder)
    table = folder / "sub-P1/beh/sub-P1_task-small_beh.tsv"
    table.parent.mkdir(parents=True)
    with AnswerFile(table) as file:
        for trial in range(1, 5):
            file.add(Answer(trial, "test", "odd", "same", "oddity", "plain", "mellow", 1.5, position=1, chosen=1))


def _answers(path: Path) -> object:
    from tangible_study.analysis.analysing import read_results

    kept = read_results(path.parents[2])
    return [kept.of(comparison) for comparison in kept.study.comparisons]


def _make_batch(folder: Path) -> None:
    import pyarrow as arrow
    import pyarrow.parquet as parquet

    (folder / "rows.csv").write_text("id,scene.photo,workspace.width_m\na,p1.png,0.05\nb,p2.png,\n")
    table = {"id": ["a", "b"], "scene.photo": ["p1.png", "p2.png"], "workspace.width_m": [0.05, None]}
    for name in ("snappy", "zstd", "none"):
        parquet.write_table(arrow.table(table), folder / f"{name}.parquet", compression=name)


def _batch(path: Path) -> object:
    from tangible_batch.manifest import find_rows

    return list(find_rows(str(path)))


def _batch_rows(path: Path) -> object:
    from tangible_batch.results import last_rows, rows_of_scenes, write_gallery, write_index

    names = list(last_rows(path.parent))
    list(rows_of_scenes(path.parent, names))
    return write_index(path.parent, names), write_gallery(path.parent, names)


BATCH_ROWS = "".join(
    json.dumps(
        {
            "id": name, "key": "k", "outcome": outcome, "error": error, "seconds": 0.5, "folder": f"scenes/{name}",
            "scene": "p.png", "figures": {"surface": {"width_mm": 40.0, "length_mm": 30.0, "height_mm": 2.0}},
            "stages": {"relief": 0.1}, "notes": ["dark"], "files": ["relief.npz", "card.jpg"], "card": "card.jpg",
        }
    ) + "\n" for name, outcome, error in (("a", "ok", None), ("b", "failed", "is not a picture"))
)  # fmt: skip


def _cameras(path: Path) -> object:
    from tangible_bench.datasets.cameras import kitti_cameras, middlebury_cameras, old_middlebury_cameras

    if path.stem == "calib":
        return middlebury_cameras(path)
    return old_middlebury_cameras(path, 3.0) if path.stem == "dmin" else kitti_cameras(path, "P2", "P3")


KITTI = "P2: 700 0 600 31.5 0 700 180 0.2 0 0 1 0.002\nP3: 700 0 600 -350 0 700 180 2.2 0 0 1 0.003\n"


def _make_kits(folder: Path) -> None:
    known = standard_sets.known()
    standard_sets.middlebury_eval3(folder / "a", known)
    standard_sets.kitti_2012(folder / "b", known)


def _kits(path: Path) -> object:
    from tangible_bench.datasets.kits import kitti_2012, since_2014

    top = next(parent for parent in path.parents if parent.name in ("a", "b"))
    pairs = since_2014(top) if top.name == "a" else kitti_2012(top)
    return [
        pair.open() for pair in pairs if pair.left.parent in path.parents or pair.left.parent.parent in path.parents
    ]


def _make_videos(folder: Path) -> None:
    pictures = [grey(number) for number in range(4)]
    write_video(folder / "film.avi", pictures)
    write_video(folder / "film.mp4", pictures, codec="mp4v")
    jpegs(folder / "film.mjpg", pictures)


def _video(path: Path) -> object:
    from tangible_core.scene.scene_files import SceneFiles
    from tangible_core.scene.video.files import read_video

    with read_video(path, SceneFiles(video=path), None).video.open() as frames:
        return [frames.next() for _ in range(6)]


def _make_networks(folder: Path) -> None:
    onnx_models.mono(folder / "mono.onnx")
    onnx_models.stereo(folder / "stereo.onnx", 2)
    (folder / "mono.yaml").write_text("output: {means: inverse-depth}\n")
    (folder / "stereo.yaml").write_text("input: {left: left, right: right}\noutput: {means: disparity-px}\n")


def _network(path: Path) -> object:
    """Check a network, and run in this process what passes the checks: what ends it is a finding."""
    from tangible_core.data import Views
    from tangible_depth import Onnx
    from tangible_networks import runtimes

    ran = {"_key": lambda *_: "ran", "Cache": lambda: {"ran"}}
    with patch.multiple(runtimes, **ran):
        return Onnx(model=path.with_suffix(".onnx")).estimate(Views(COLOURS, COLOURS[:, ::-1]))


CARD = """\
title: My network
file: mine.onnx
source: https://example.org/mine
sha256: ""
input: {left: l, right: r, order: rgb, white: 1, mean: [0.485, 0.456, 0.406], std: [1, 1, 1], size_px: [48, 64]}
output: {name: disparity, means: disparity-px, confidence: sure}
"""


def _make_cache(folder: Path) -> None:
    from tangible_core.data import Calibration, DisparityMap, HapticSurface, Note, Relief, SegmentMap, Views
    from tangible_core.pipeline.engine.cache import Cache

    cache, relief = Cache(folder), Relief(MAP, (0.16, 0.12))
    notes = {"disparity": (Note("dark", "warning"),)}
    cache.put("0" * 32, Views(COLOURS, COLOURS, Calibration(100.0, 0.1)), notes)
    cache.put("1" * 32, DisparityMap(MAP, MAP, "px"), notes)
    cache.put("2" * 32, SegmentMap(LABELS.astype(np.int32)), notes)
    cache.put("3" * 32, HapticSurface(relief), notes)


def _cache(path: Path) -> object:
    from tangible_core.pipeline.engine.cache import Cache

    cache = Cache(path.parent)
    return cache.notes(path.stem), cache.entry(path.stem), cache.size()


def _make_device(folder: Path) -> None:
    from tangible_devices.falcon.calibration import Calibration

    (folder / "devices").mkdir()
    (folder / "devices/falcon-any.json").write_text(Calibration().model_dump_json(indent=2))


def _device(path: Path) -> object:
    from tangible_devices.device_calibrations import load_calibration
    from tangible_devices.falcon.calibration import Calibration

    with patch.dict(os.environ, TANGIBLE_CONFIG_DIR=str(path.parent.parent)):
        return load_calibration("falcon", "", Calibration)


FIRMWARE = np.array([0x08AA, *[0] * 8, 0, 0, 2, 0, 64, 1, 2, 3, 0, 80, 1, 2, 3, 0], "<u2").tobytes()


def _draft(path: Path) -> object:
    from tangible_ui.state import document as drafts

    return drafts._read(path)


def _request(path: Path) -> object:
    from tangible_ui.requests import REQUESTS
    from tangible_web.parsing import parse

    return parse(path.read_bytes().decode(errors="replace"), REQUESTS.get)


REQUESTS = {
    "find.json": {"number": 1, "ask": "open_batch", "batch": "a"},
    "more.json": {"number": 2, "ask": "parts_propose", "points": [[1, 2.5], [3, 4]], "width_px": 3.5},
}


def _uploaded_labels(path: Path) -> object:
    from tangible_ui.worker.parts.saving import is_ours, unpack

    return is_ours(path, "p.yaml") if path.suffix == ".png" else unpack(path, LABELS.shape)


def _make_uploads(folder: Path) -> None:
    import gzip

    from tangible_ui.worker.parts.saving import as_png

    (folder / "labels.gz").write_bytes(gzip.compress(LABELS.astype("<u2").tobytes()))
    (folder / "parts.png").write_bytes(as_png(LABELS.astype(np.int32), "p.yaml"))


def _members(make: Callable[[Path], object], name: str) -> Callable[[Path], object]:
    """Write the arrays of an archive as files, which are damaged and then packed: else its check sums find all."""

    def write(folder: Path) -> None:
        make(folder)
        with zipfile.ZipFile(next(folder.rglob(name))) as archive:
            members = {each: archive.read(each) for each in archive.namelist()}
        for path in folder.iterdir():
            path.unlink()
        for member, data in members.items():
            (folder / member).write_bytes(data)

    return write


def _packed(read: Callable[[Path], object], name: str) -> Callable[[Path], object]:
    def read_archive(path: Path) -> object:
        archive = path.parent.parent / name
        with zipfile.ZipFile(archive, "w", strict_timestamps=False) as file:
            for member in path.parent.iterdir():
                file.write(member, member.name)
        return read(archive)

    return read_archive


def _check_sums(data: bytes) -> bytes:
    """Return a PNG with the check sums of its chunks put right."""
    whole, at = bytearray(data), 8
    while at + 12 <= len(whole):
        (size,) = struct.unpack_from(">I", whole, at)
        if (end := at + 8 + size) + 4 > len(whole):
            break
        struct.pack_into(">I", whole, end, zlib.crc32(whole[at + 4 : end]))
        at = end + 4
    return bytes(whole)


def _make_study_folder(folder: Path) -> None:
    from tangible_study.session.folder import Place, enrol, prepare, write_sidecar
    from tangible_study.study_file import load_study

    file = load_study(studies.write_study(folder))
    root = folder / "out"
    root.mkdir()
    prepare(root, file)
    enrol(root, "P1", file.study, False)
    enrol(root, "P2", file.study, False)
    place = Place(root, "P1", "small")
    write_sidecar(place, file, {"Faults": ["late"], "Device": "mock"})


@cache
def _study_once(path: Path) -> Any:
    from tangible_study.study_file import load_study

    return load_study(path)


def _study_folder(path: Path) -> object:
    from tangible_study.session.folder import Place, check_name, faults_before, participants, prepare

    root = next(parent for parent in path.parents if parent.name == "out")
    prepare(root, _study_once(root.parent / "study.yaml"))
    return participants(root), faults_before(Place(root, "P1", "small")), check_name(root, "P1", resume=True)


READERS = {
    "png": Reader(
        _all(
            _image("a.png", COLOURS), _image("b.png", DEEP), _palette("c.png"), _several("d.png"),
            _by_opencv("e.png", np.dstack([DEEP] * 3)), _image("f.png", np.dstack([COLOURS, GREY])),
        ),
        _picture,
        repair=_check_sums,
    ),
    "jpeg": Reader(_all(_image("a.jpg", COLOURS), _image("b.jpg", GREY, progressive=True)), _picture),
    "tiff": Reader(
        _all(
            _image("a.tif", COLOURS), _image("b.tif", MAP, compression="tiff_lzw"), _several("c.tif"),
            _image("d.tif", DEEP, compression="tiff_adobe_deflate"), _by_opencv("e.tif", np.dstack([DEEP] * 3)),
            _image("f.tif", COLOURS, compression="jpeg"), _image("g.tif", GREY, compression="packbits"),
        ),
        _picture,
    ),
    "webp": Reader(_all(_image("a.webp", COLOURS), _several("b.webp", lossless=True)), _picture),
    "bmp": Reader(_all(_image("a.bmp", COLOURS), _palette("b.bmp")), _picture),
    "gif": Reader(_all(_several("a.gif"), _palette("b.gif")), _picture),
    "pnm": Reader(
        _all(
            _image("a.ppm", COLOURS), _image("b.pgm", GREY), _image("c.pgm", DEEP),
            _bytes("d.pgm", "P2\n# x\n4 2\n255\n1 2 3 4\n5 6 7 8\n"), _bytes("e.pbm", "P1\n4 2\n1 0 1 0\n0 1 0 1\n"),
        ),
        _picture,
    ),
    "jpeg-2000": Reader(
        _all(
            _image("a.jp2", COLOURS), _image("b.jp2", GREY, irreversible=True),
            _bytes("c.jp2", imagecodecs.jpeg2k_encode(DEEP, level=0)),
        ),
        _picture,
    ),
    "npy": Reader(_npy, _picture),
    "npz": Reader(_npz, _map),
    "pfm": Reader(_pfm, _map),
    "map-tiff": Reader(
        _all(
            _geotiff, _image("b.tif", DEEP), _by_opencv("c.tif", MAP.astype(np.float64)),
            _tiff("d.tif", MAP, byteorder=">", compression="deflate", predictor=3),
            _tiff("e.tif", DEEP, bigtiff=True, compression="lzw", predictor=2, rowsperstrip=5),
            _tiff("f.tif", MAP, compression="zstd", tile=(16, 16)),
        ),
        _map,
    ),
    "grid": Reader(
        _all(
            _bytes("a.asc", "ncols 3\nnrows 2\ncellsize 5\nNODATA_value -1\n1 2 3\n4 -1 6.5\n"),
            _bytes("b.flt", MAP.tobytes()), _bytes("c.hgt", DEEP[:12, :12].astype(">i2").tobytes()),
            _bytes("b.hdr", "nrows 12\nncols 16\nnodata -1\n"),
        ),
        _map,
        "*.[ahf][sgl]*",
        text=True,
    ),
    "grid-header": Reader(
        _all(_bytes("b.bil", DEEP.tobytes()), _bytes("b.hdr", "nrows 12\nncols 16\nnbits 16\nbyteorder M\n")),
        lambda path: _map(path.with_suffix(".bil")),
        "*.hdr",
        text=True,
    ),
    "heic": Reader(
        lambda folder: pillow_heif.from_pillow(Image.fromarray(np.kron(COLOURS, np.ones((4, 4, 1), np.uint8)))).save(
            folder / "a.heic"
        ),
        _picture,
    ),
    "avif": Reader(_all(_image("a.avif", COLOURS), _image("b.avif", GREY)), _picture),
    "ground": Reader(_make_ground, _reader("tangible_core.scene.formats.ground", "read_ground")),
    "labels": Reader(
        _all(_image("a.png", LABELS), _palette("b.png"), lambda f: np.save(f / "c.npy", LABELS)),
        _reader("tangible_core.scene.formats.pictures", "read_labels"),
    ),
    "truth": Reader(_all(_image("kitti.png", DEEP), _image("sintel.png", COLOURS), _pfm), _truth),
    "large-picture": Reader(
        _all(
            _image("a.png", COLOURS), _image("b.tif", COLOURS), _image("c.jpg", COLOURS), _image("d.png", DEEP),
            _image("e.tif", GREY, compression="tiff_adobe_deflate"), _palette("f.png"), _image("g.tif", MAP),
        ),
        _large,
        repair=lambda data: _check_sums(data) if data[:4] == b"\x89PNG" else data,
    ),
    "pair": Reader(
        _all(
            _make_jps,
            lambda folder: phone_photos.write_mpo(folder / "pair.mpo", [COLOURS, COLOURS // 2], 0x020002),
            _image("both.png", np.hstack([COLOURS, COLOURS])),
        ),
        _reader("tangible_core.scene.formats.pairs", "read_pair"),
    ),
    "phone-photo": Reader(_make_phone, _photo),
    "cameras-of-a-rig": Reader(_make_rigs, _rig, "[!r]*.*", text=True),
    "cameras-of-opencv": Reader(_make_rigs, _rig, "rig.*", text=True),
    "heights-in-mm": Reader(_make_heights, _heights),
    "heights-metadata": Reader(_make_heights, _heights, "*.json", text=True),
    "pipeline": Reader(_make_pipelines, _pipeline, "*.yaml", text=True),
    "pipeline-edited": Reader(_make_pipelines, _edits, "*.yaml", text=True),
    "materials": Reader(
        _bytes("library.yaml", MATERIALS), _reader("tangible_core.materials.assignment", "load_library"), text=True
    ),
    "recording": Reader(_make_recordings, _recording),
    "recording-csv": Reader(_make_recordings, _recording, "*.csv", text=True),
    "stroke": Reader(_bytes("s.csv", STROKE), _stroke, text=True),
    "run-folder": Reader(_make_run, _run, "*.json", text=True),
    "export-list": Reader(_make_exports, _exports, text=True),
    "results": Reader(_make_results, _results, text=True),
    "comparison": Reader(_make_comparisons, _comparison, text=True),
    "study": Reader(studies.write_study, _study, "study.yaml", text=True),
    "answers": Reader(_make_answers, _answers, "*.tsv", text=True),
    "batch-csv": Reader(_make_batch, _batch, "*.csv", text=True),
    "batch-parquet": Reader(_make_batch, _batch, "*.parquet"),
    "batch-rows": Reader(_bytes("rows.jsonl", BATCH_ROWS), _batch_rows, text=True),
    "kit-cameras": Reader(
        _all(_bytes("calib.txt", standard_sets.CALIB), _bytes("dmin.txt", "270\n"), _bytes("000000.txt", KITTI)),
        _cameras,
        text=True,
    ),
    "kit": Reader(_make_kits, _kits, "*.p*"),
    "video": Reader(_make_videos, _video),
    "network": Reader(_make_networks, _network, "*.onnx"),
    "network-inputs": Reader(_make_networks, _reader("tangible_networks.onnx_file", "read_inputs"), "*.onnx"),
    "network-card": Reader(_bytes("card.yaml", CARD), _reader("tangible_networks.card", "read_card"), text=True),
    "cache": Reader(_make_cache, _cache, "*.npz"),
    "cache-members": Reader(_members(_make_cache, f"{'1' * 32}.npz"), _packed(_cache, f"{'1' * 32}.npz"), text=True),
    "recording-members": Reader(_members(_make_recordings, "*.npz"), _packed(_recording, "stroke.npz")),
    "study-folder": Reader(_make_study_folder, _study_folder, "out/**/*.*s*", text=True),
    "device-calibration": Reader(_make_device, _device, "*.json", text=True),
    "firmware": Reader(_bytes("firmware.bin", FIRMWARE), _reader("tangible_devices.falcon.usb.image", "read_image")),
    "draft": Reader(_bytes("draft.json", json.dumps({"text": "scene: x\n", "path": "/tmp/p.yaml"})), _draft, text=True),
    "request": Reader(
        _all(*(_bytes(name, json.dumps(request)) for name, request in REQUESTS.items())), _request, text=True
    ),
    "uploaded-labels": Reader(_make_uploads, _uploaded_labels),
}  # fmt: skip


def report(name: str, folder: str, count: int) -> None:
    """Read the valid files, then so many damaged ones, and print the first of those that should not be."""
    cv2.setNumThreads(1)  # the threads of its pool would not come along into the forks that read
    seeds = Path(folder, "seeds")
    seeds.mkdir()
    damage = Damage(name, READERS[name], seeds)
    assert damage.valid
    for path in damage.valid:
        damage.reader.read(path)
    for each in islice(damage.findings(range(count)), 10):
        print(f"{name} {each.number}: {each.what} {each.data}")


if __name__ == "__main__":
    import sys

    from mutated import main

    cv2.setNumThreads(1)
    first, last, *names = sys.argv[1:]
    main(READERS, names or list(READERS), int(first), int(last))
