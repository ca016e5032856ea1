"""The channels of a picture in which boundaries are detected."""

import numpy as np
from jaxtyping import Float32

from tangible_core.data import check_picture, full_scale, luma


def channels(picture: np.ndarray, colour: bool) -> Float32[np.ndarray, "h w c"]:
    """Return red, green and blue over white; or grey, if `colour` is False or there is none. Raises: PictureError."""
    picture = check_picture(picture)
    white = full_scale(picture)
    paint = np.atleast_3d(picture)[..., :3]
    has_colour = any(np.any(paint[..., 0] != paint[..., other]) for other in range(1, paint.shape[2]))
    values = _share(paint if has_colour else paint[..., :1], white)
    if picture.ndim == 3 and picture.shape[2] == 4:
        opaque = _share(picture[..., 3:], white)
        values = values * opaque + (1 - opaque)
    if values.shape[2] == 3 and not colour:
        values = luma(values)[..., None]
    # The largest magnitude is 1 for any scale, so that later squares neither overflow nor vanish.
    top = max(float(values.max()), -float(values.min()))
    return np.ascontiguousarray(values / top if top else values, np.float32)


def _share(values: np.ndarray, white: float) -> Float32[np.ndarray, "h w c"]:
    """Return values as shares of white, divided in single precision at least, so that every dtype gives the same."""
    return np.asarray((values if values.dtype.kind == "f" else values.astype(np.float32)) / white, np.float32)
