"""Textures in folders and archives, for fitting: pictures that look the same everywhere, none a repeat of another."""

import io
import re
from collections.abc import Iterator
from functools import cache
from multiprocessing import Pool
from pathlib import Path
from typing import NamedTuple
from zipfile import BadZipFile, ZipFile

import cv2
import numpy as np
from PIL import Image

# The least side of a picture; the least side above which it is halved; what is kept of it.
MIN_PX, MAX_PX, CROP_PX = 256, 900, 640
SPREAD, TURN = 0.3, 0.14
"""The largest deviation, between 16 parts of a texture, of the logarithm of energies, and of their directions."""
ALIKE = 0.9  # the correlation of thumbnails from which two pictures are the same
FLATTEST = 1.5  # the least local contrast, in grey levels, that 95 % of a texture must have
ENDINGS, ARCHIVES = frozenset((".png", ".jpg", ".jpeg", ".tga", ".rgb", ".dds")), frozenset((".zip", ".pk3", ".mpz"))
# Names of pictures that are no textures: maps of normals and gloss, faces of dials, signs.
OTHER = re.compile(
    r"norm|_local|_gloss|_glow|_bump|_nm\b|_[nsh]\.|_spec|mask|gui|icon|font|levelshot|env/|sky|skin|minimap|_lum|"
    r"_reflect|hud|menu|karts/|wheel|driver|crosshair|logo|height|screenshot|loading|license|flag|sign|poster",
    re.IGNORECASE,
)


class Texture(NamedTuple):
    """A texture in grey, and its thumbnail of mean 0 and length 1."""

    grey: np.ndarray
    thumbnail: np.ndarray


def find_textures(folders: list[Path], processes: int = 2) -> list[np.ndarray]:
    """Return the textures of the folders, uint8 (h, w), each once."""
    cv2.setNumThreads(1)
    with Pool(processes) as pool:
        found = [each for each in pool.imap(_open, sorted(_names(folders)), 16) if each is not None]
    kept: list[Texture] = []
    for each in found:
        if not kept or float(np.max([other.thumbnail @ each.thumbnail for other in kept])) < ALIKE:
            kept.append(each)
    return [each.grey for each in kept]


def _names(folders: list[Path]) -> Iterator[tuple[Path, str]]:
    for path in (path for folder in folders for path in folder.rglob("*") if path.is_file()):
        if path.suffix.lower() in ENDINGS and not OTHER.search(str(path)):
            yield path, ""
        elif path.suffix.lower() in ARCHIVES:
            try:
                members = ZipFile(path).namelist()
            except BadZipFile:
                continue
            yield from (
                (path, name) for name in members if Path(name).suffix.lower() in ENDINGS and not OTHER.search(name)
            )


@cache
def _archive(path: Path) -> ZipFile:
    return ZipFile(path)


def _open(place: tuple[Path, str]) -> Texture | None:
    path, member = place
    try:
        data = _archive(path).read(member) if member else path.read_bytes()
        with Image.open(io.BytesIO(data)) as opened:
            if min(opened.size) < MIN_PX or ("A" in opened.mode and _is_cut_out(opened)):
                return None
            colours = np.asarray(opened.convert("RGB"), np.float32)
    except (OSError, ValueError, SyntaxError, BadZipFile):  # what Pillow raises for what it cannot read
        return None
    if (np.abs(np.linalg.norm(colours / 127.5 - 1, axis=2) - 1) < 0.08).mean() > 0.8:  # normals, of length 1
        return None
    grey = colours @ np.array([0.299, 0.587, 0.114], np.float32)
    while min(grey.shape) > MAX_PX:
        grey = cv2.resize(grey, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    grey = grey[:CROP_PX, :CROP_PX]
    return _texture(grey) if min(grey.shape) >= MIN_PX and grey.std() >= 4 and _is_even(grey) else None


def _is_cut_out(picture: Image.Image) -> bool:
    return bool((np.asarray(picture.getchannel("A")) < 128).mean() > 0.02)


def _texture(grey: np.ndarray) -> Texture:
    small = cv2.resize((grey - grey.mean()) / grey.std(), (16, 16), interpolation=cv2.INTER_AREA).ravel()
    return Texture(grey.clip(0, 255).astype(np.uint8), small / np.linalg.norm(small))


def _is_even(grey: np.ndarray) -> bool:
    detail = grey - cv2.GaussianBlur(grey, (0, 0), 24)
    contrast = np.sqrt(cv2.GaussianBlur(detail**2, (0, 0), 24))
    if np.percentile(contrast, 5) < FLATTEST:
        return False
    even = finer = detail / (contrast + 1e-3)
    energies: list[np.ndarray] = []
    for sigma in (1.5, 3, 6, 12):
        coarser = cv2.GaussianBlur(even, (0, 0), sigma)
        across, down = (cv2.Sobel(finer - coarser, -1, *order) for order in ((1, 0), (0, 1)))
        energies += [
            cv2.resize(each, (4, 4), interpolation=cv2.INTER_AREA).ravel()
            for each in (across**2, down**2, across * down)
        ]
        finer = coarser
    across, down, both = np.stack(energies).reshape(4, 3, 16).transpose(1, 0, 2)
    whole = across + down + 1e-9
    direction = np.stack([across - down, 2 * both]) / whole
    return bool(np.log(whole + 1e-6).std(axis=1).mean() < SPREAD and direction.std(axis=2).mean() < TURN)
