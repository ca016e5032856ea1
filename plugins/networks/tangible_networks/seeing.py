"""What the networks that are here see in one photograph."""

import logging
from collections.abc import Collection
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from tangible_core.data import Figure, to_rgb
from tangible_core.errors import ConfigError
from tangible_core.plugins import note

from .card import Runtime, Task
from .fitting import Colours, fit_size, resize, restore_size, tensor
from .runtimes import run
from .store import networks_here

log: logging.Logger = logging.getLogger(__name__)
MAX_PX = {"figure": 102_400, "borders": 154_401, "faces": 4_000_000}
"""Largest number of pixels that a network sees: those of the pictures that it was trained with; more shows no more of
a figure, and borders of textures."""
SURE = 0.5  # least value of a figure's surest pixel


def look(picture: np.ndarray, tasks: Collection[Task] = ("figure", "borders", "faces")) -> Figure:
    """Return the figure, the borders and the faces of a picture, as far as there are networks for these tasks.

    picture: uint8, uint16 or float (h, w), (h, w, 3) or (h, w, 4).
    Raises: ConfigError for a network that cannot run.
    """
    colours = to_rgb(picture)
    borders = look_for_borders(colours, colours.shape[:2]) if "borders" in tasks else None
    figure = look_for_figure(colours) if "figure" in tasks else None
    return Figure(figure, borders, _faces(colours) if "faces" in tasks else None)


def look_for_borders(colours: Colours, shape: tuple[int, int]) -> Float32[np.ndarray, "r c"] | None:
    """Return how surely people would draw a border at each pixel of this size; None without a network."""
    borders = _map(colours, "borders")
    return None if borders is None else restore_map(borders, shape)


def look_for_figure(colours: Colours) -> Float32[np.ndarray, "h w"] | None:
    """Return how surely each pixel belongs to the figure; 0 in a picture without one, None without a network."""
    figure = _map(colours, "figure")
    if figure is None:
        return None
    return restore_map(figure if float(figure.max()) > SURE else np.zeros_like(figure), colours.shape[:2])


def restore_map(values: Float32[np.ndarray, "r c"], shape: tuple[int, int]) -> Float32[np.ndarray, "h w"]:
    """Return a map in another size, in 0..1."""
    return np.clip(resize(values, shape), 0, 1)


def _map(colours: Colours, task: Task) -> Float32[np.ndarray, "r c"] | None:
    networks = networks_here(task)
    if not networks:
        return None
    network = networks[0]
    card = network.card
    fit = fit_size(colours.shape[:2], card.input, MAX_PX[card.task])
    given = tensor(resize(colours, fit.resized), card.input, fit)
    model = network.path, card.runtime or "opencv", card.input.left, card.output.name
    output = _run_once(*model, network.path.stat().st_mtime_ns, given.tobytes(), given.shape)
    values = restore_size(output, fit, fit.resized, card.output.channel)
    if values is None:
        raise ConfigError(f"the network {network.name} returns no map; name another output in its card")
    note(log, f"{card.task}: seen by the network {network.name}")
    if not card.verified:
        note(log, f"the card of {card.title} was never tested with its network", logging.WARNING)
    return values


@lru_cache(maxsize=2)
def _run_once(
    path: Path, runtime: Runtime, left: str, output: str, changed_ns: int, given: bytes, shape: tuple[int, ...]
) -> np.ndarray:
    """Return a network's map: several stages ask for the borders of one picture."""
    return run(path, runtime, {left: np.frombuffer(given, np.float32).reshape(shape)}, [output])[0]


def _faces(colours: Colours) -> Float32[np.ndarray, "n 468 3"] | None:
    here = {network.name: network for network in networks_here("faces")}
    if not {"face-finder", "face-points"} <= here.keys():
        return None
    from .faces import find_faces

    reduction = max(1.0, (colours.shape[0] * colours.shape[1] / MAX_PX["faces"]) ** 0.5)
    small = resize(colours, (round(colours.shape[0] / reduction), round(colours.shape[1] / reduction)))
    faces = find_faces(small, here["face-finder"], here["face-points"])
    if len(faces):
        note(log, f"{len(faces)} {'face' if len(faces) == 1 else 'faces'} found by the network face-points")
    return (faces * np.float32(colours.shape[1] / small.shape[1])).astype(np.float32)
