"""Fake flights: all measurements of a machine are fixed, so that every verdict is known."""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from tangible_core import HapticSurface, load_method
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import DeviceSpec, Material
from tangible_core.preflight.flight import Flight, Hand, Settings
from tangible_core.preflight.probes import probe, stroke
from tangible_core.preflight.timing import Lateness, TickCost
from tangible_core.preflight.verdict import Verdict
from tangible_core.scene.workspace import Workspace

SPEC = DeviceSpec(
    max_force_n=8.0,
    max_stiffness_n_per_m=10_000.0,
    damping_n_s_per_m=2.0,
    workspace_m=(0.1, 0.1, 0.1),
    resolution_m=1e-5,
)
"""A device that renders 4000 N/m by its damping at 1 kHz without delay; a guard leaves 3200 to a force law."""


def fly(surface: HapticSurface, law: str = "proxy", device: Any = None, **changes: Any) -> Flight:
    """Return a flight over a surface; `changes` are options of the law, or fields of the hand, device or flight."""
    method = load_method("render", law)
    options = {name: changes.pop(name) for name in list(changes) if name in method.model_fields}
    of_spec = {name: changes.pop(name) for name in list(changes) if name in vars(SPEC)}
    of_hand = {name: changes.pop(name) for name in list(changes) if name in vars(Hand())}
    spec, hand, renderer = replace(SPEC, **of_spec, **(device or {})), Hand(**of_hand), method(**options)
    touch = renderer.touch(surface)
    assert isinstance(touch, CompiledTouch)
    period_s = changes.pop("period_s", 0.001)
    stiffness = touch.stiffness_n_per_m
    size = Workspace().size("depth")._replace(relief_m=changes.pop("relief_m", 0.02))
    of_file = {name: changes.pop(name) for name in list(changes) if name in vars(Settings())}
    fields: dict[str, Any] = {
        "probes": probe(touch, surface, hand.press_n, stiffness, spec.workspace_m[2], period_s),
        "strokes": stroke(touch, surface, hand.press_n, hand.speed_m_per_s, period_s),
        "lateness": Lateness(np.full(1000, 1e-5), period_s, True),
        "cost": TickCost(np.full(1000, 2e-6), 1e-6),
    } | changes
    settings = Settings(**{"size": size, "law_name": law} | of_file)
    return Flight(surface, renderer, stiffness, spec, settings, hand=hand, period_s=period_s, **fields)


def level(height_m: float = 0.01, cells: int = 32, **materials: Any) -> HapticSurface:
    """Return level ground, 80 mm wide."""
    return HapticSurface.from_heights(np.full((cells, cells), height_m, np.float32), **materials)


def shape(height_m: Callable[[np.ndarray, np.ndarray], Any], cells: int = 128, width_m: float = 0.08) -> HapticSurface:
    """Return a surface whose heights are a function of x and y, lifted so that its lowest point is 0."""
    at = ((np.arange(cells) + 0.5) / cells - 0.5) * width_m
    x, y = np.meshgrid(at, -at)
    heights = np.broadcast_to(height_m(x, y), x.shape)
    return HapticSurface.from_heights(heights - heights.min(), width_m)


def half_slope(slope: float, cells: int = 128) -> HapticSurface:
    """Return a surface that is level on the left and rises with this slope on the right."""
    return shape(lambda x, y: slope * np.maximum(x, 0), cells)


def material(name: str = "made-up", **values: Any) -> Material:
    """Return a material with these values."""
    plain = {"stiffness_n_per_m": 500.0, "damping_n_s_per_m": 0.0, "static_friction": 0.0, "dynamic_friction": 0.0}
    return Material(name, **{**plain, "texture": "smooth", **values})


def of(verdicts: Any, what: str) -> Verdict:
    """Return the one verdict of this thing."""
    [found] = [verdict for verdict in verdicts if verdict.of == what]
    return found


def grades(verdicts: Any) -> list[str]:
    return [verdict.verdict for verdict in verdicts]


def value_in_cure(verdict: Verdict, key: str) -> float:
    """Return the value of a key in the text of the cure."""
    return float(re.search(rf"{re.escape(key)}: ([\d.e-]+)", verdict.cure)[1])


def surface_with_materials(*materials: Any) -> HapticSurface:
    """Return level ground with a stripe of each material."""
    labels = (np.arange(32) * len(materials) // 32).astype(np.int32)
    return level(labels=np.tile(labels, (32, 1)), materials=materials)
