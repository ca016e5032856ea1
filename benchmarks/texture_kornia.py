"""`kornia-gabor` on the CPU: the same labels as our own bank with the same clustering, and its time."""

from functools import partial

import numpy as np

from tangible_bench.metrics.segments import segment_errors
from tangible_core.data.pictures import to_grey
from tangible_core.testing.synthetic.texture_scenes import KnownSegments
from tangible_texture.energies.gabor_bank import bank, octaves
from tangible_texture.energies.local_energy import energy_planes, padding, spectrum_of
from tangible_texture.kmeans.labelling import segment_by_kmeans
from tangible_texture.kornia_gabor import KorniaGabor

from .figures import Figure
from .texture_scenes import some
from .turns import in_turns

ROUNDS = 3
MOSAICS = 3


def figures() -> list[Figure]:
    """Return the promise about torch."""
    scenes = dict(list(some().items())[:MOSAICS])
    agreements, accuracies = {}, []
    for name, scene in scenes.items():
        theirs = _kornia(scene)
        agreements[name] = segment_errors(theirs, _our_bank(scene))["ari"]
        accuracies.append(segment_errors(theirs, scene.labels)["ari"])
    worst = min(agreements, key=agreements.__getitem__)
    scene = next(iter(scenes.values()))
    times = in_turns({"ours": partial(_our_bank, scene), "kornia": partial(_kornia, scene)}, ROUNDS)
    return [
        Figure(
            "`kornia-gabor` on the CPU",
            "ARI >= .95 to our bank's labels; its time",
            f"mean {np.mean(list(agreements.values())):.3f}, worst {agreements[worst]:.3f} ({worst}); "
            f"{1e3 * times['kornia'].seconds:.0f} ms, {times['kornia'].ratio:.1f} x our bank with the same k-means; "
            f"ARI to the truth {np.mean(accuracies):.3f}",
            agreements[worst] >= 0.95,
        )
    ]


def _kornia(scene: KnownSegments) -> np.ndarray:
    method = KorniaGabor(segments=scene.count, torch_device="cpu", skip_octaves=False, drop_seams=False)
    return method.segment(scene.picture).labels


def _our_bank(scene: KnownSegments) -> np.ndarray:
    """Return the same bank, windows, features and starts, without torch; nothing is skipped or dropped in either."""
    options = KorniaGabor()
    grey, filters = to_grey(scene.picture), bank(octaves(options.longest_px))
    spectrum = spectrum_of(grey, padding(filters, options.window_px))
    planes = energy_planes(spectrum, filters, grey.shape, options.step_px, options.window_px)
    roots = np.sqrt(np.moveaxis(planes, 0, 2))
    features = (roots - roots.mean(axis=(0, 1))) / roots.std(axis=(0, 1))
    return segment_by_kmeans(
        features, options.step_px, grey.shape, scene.count, options.seed, restarts=options.restarts
    ).labels
