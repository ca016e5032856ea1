"""A picture to send, with texts that try to be markup, and what its page is asked."""

from dataclasses import replace

import numpy as np

from tangible_core.data import HapticSurface, Material, MaterialMap, Relief, Work

ROWS, COLUMNS, WIDE_M = 90, 120, 0.12
HOSTILE = (
    "</script><script>window.broken = 1</script>",
    "\"'><img src=x onerror=alert(1)>\u2028\u2029\u202egnol -->",
    "שלום <b>",
)
"""Names of the parts: two that try to end what they stand in, and one that is read from right to left."""
MATERIALS = (
    Material("felt", 300.0, 1.5, 0.5, 0.4, 2e-5, 0.001),
    Material("</script>", 900.0, 0.5, 0.2, 0.1),
    Material("ice", 1200.0, 0.0, 0.0, 0.0),
)


def picture_to_send(title: str = HOSTILE[2]) -> Work:
    """A wavy ground with a box and a ramp on it, each a part with a material, and a picture of noise."""
    random = np.random.default_rng(5)
    y, x = np.mgrid[:ROWS, :COLUMNS].astype(np.float32)
    height_m = 0.002 + 0.0008 * np.sin(x / 7) * np.cos(y / 9) + random.normal(0, 5e-6, x.shape).astype(np.float32)
    labels = np.zeros((ROWS, COLUMNS), np.int32)
    labels[20:50, 15:55], labels[30:80, 70:105] = 1, 2
    height_m = np.where(labels == 1, np.float32(0.006), height_m)
    height_m = np.where(labels == 2, np.float32(0.001) + (x - 70) * np.float32(1e-4), height_m).astype(np.float32)
    surface = HapticSurface(Relief(height_m, (WIDE_M, WIDE_M * ROWS / COLUMNS)), labels, MATERIALS, HOSTILE)
    picture = random.integers(0, 255, (270, 360, 3), dtype=np.uint8)
    materials = MaterialMap(MATERIALS, ("made up",) * 3)
    return Work(title, "he", {"surface": surface, "materials": materials}, picture, HOSTILE)


def finer(work: Work, times: int) -> Work:
    """The same picture with as many more cells along each side, rough ones."""
    surface = work.surface
    height_m = surface.height_m.repeat(times, 0).repeat(times, 1)
    rough_m = np.random.default_rng(6).uniform(0, 1e-3, height_m.shape).astype(np.float32)
    labels = None if surface.labels is None else surface.labels.repeat(times, 0).repeat(times, 1)
    finer = replace(surface, relief=Relief(height_m + rough_m, surface.extent_m), labels=labels)
    return replace(work, products={**work.products, "surface": finer})


def touches(count: int) -> np.ndarray:
    """Positions of a hand, (ticks, 3), which goes down at many places, deep, and a millimetre aside."""
    random = np.random.default_rng(7)
    half_m = 0.48 * np.array([WIDE_M, WIDE_M * ROWS / COLUMNS])
    paths = []
    for _ in range(count):
        place_m, aside = random.uniform(-half_m, half_m), random.uniform(0, 2 * np.pi)
        down = np.concatenate([np.full((1, 2), place_m), np.repeat(place_m[None], 29, 0)])
        deep_m = np.concatenate([[0.01], np.linspace(0.0095, random.uniform(-0.001, 0.001), 29)])
        along = place_m + np.linspace(0, 0.001, 11)[1:, None] * [np.cos(aside), np.sin(aside)]
        paths.append(np.vstack([np.column_stack([down, deep_m]), np.column_stack([along, np.full(10, deep_m[-1])])]))
    return np.concatenate(paths)
