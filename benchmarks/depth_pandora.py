"""CNES pandora (the extra `peers`): census 5x5, semi-global matching, V-fit, both views checked against each other."""

import logging
import os
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tangible_core.data import DisparityMap
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real
from .figures import Figure
from .turns import in_turns

PIPELINE = {
    "matching_cost": {"matching_cost_method": "census", "window_size": 5, "subpix": 1},
    "optimization": {"optimization_method": "sgm", "penalty": {"penalty_method": "sgm_penalty"}},
    "disparity": {"disparity_method": "wta", "invalid_disparity": "NaN"},
    "refinement": {"refinement_method": "vfit"},
    "filter": {"filter_method": "median"},
    "validation": {"validation_method": "cross_checking_accurate"},
}


def figures(rounds: int = 2) -> list[Figure]:
    """Error and time of both on the builtin pair."""
    from tangible_bench.tasks.depth import fill, measure

    what, bound = "against pandora: census5 + SGM + vfit, motorcycle", "less error, <= 1/50 of its time"
    scene = real()["motorcycle"]
    try:
        theirs = pandora(scene)
    except ImportError:
        return [Figure(what, bound, "not measured: pandora is not installed (pip install 'pandora[sgm]')", False)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = fill(DisparityMap(theirs()))
        times = in_turns({"pandora": theirs, "ours": lambda: SemiGlobal().estimate(scene.views)}, rounds)
    peer, ours = measure(found, scene.pair), measure(SemiGlobal().estimate(scene.pair.views), scene.pair)
    share = times["ours"].ratio
    measured = (
        f"bad2 {ours['bad2']:.2f} / {ours['bad2_noc']:.2f} % (all / noc) against {peer['bad2']:.2f} / "
        f"{peer['bad2_noc']:.2f} %; 1/{1 / share:.0f} of {times['pandora'].seconds:.1f} s"
    )
    return [Figure(what, bound, measured, ours["bad2"] < peer["bad2"] and share <= 1 / 50)]


def pandora(scene: KnownScene) -> Callable[[], np.ndarray]:
    """Return a call that gives pandora's disparity in pixels, NaN where it found none; reading the files is not in it.

    Raises: ImportError if pandora or its plugin is not installed.
    """
    import pandora as peer
    import pandora_plugin_libsgm  # noqa: F401 - so that its absence is known here
    from pandora.check_configuration import check_conf
    from pandora.constants import Criteria
    from pandora.img_tools import create_dataset_from_inputs
    from pandora.state_machine import PandoraMachine
    from PIL import Image

    logging.getLogger("transitions").setLevel(logging.ERROR)
    peer.import_plugin()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that pictures have no place on earth
        files = [Path(folder) / name for name in ("left.png", "right.png")]
        for file, view in zip(files, scene.grey, strict=True):
            Image.fromarray(view).save(file)
        most = scene.disparities - 1
        # Its disparity is the shift from left to right, ours from right to left: so left looks from -most to 0.
        ranges = {"left": [-most, 0], "right": [0, most]}
        inputs = {side: {"img": os.fspath(f), "disp": ranges[side]} for side, f in zip(ranges, files, strict=True)}
        machine = PandoraMachine()
        config = check_conf({"input": inputs, "pipeline": PIPELINE}, machine)
        left, right = (create_dataset_from_inputs(config["input"][side]) for side in ("left", "right"))

    def match() -> np.ndarray:
        found, _ = peer.run(machine, left, right, config)
        wrong = found["validity_mask"].to_numpy() & Criteria.PANDORA_MSK_PIXEL_INVALID.value
        disparity = -found["disparity_map"].to_numpy().astype(np.float32)
        return np.where(wrong != 0, np.float32(np.nan), disparity)

    return match
