"""The channels of a picture in which boundaries are looked for."""

import numpy as np
from jaxtyping import Float32

from tangible_core.pictures import check_picture, full_scale, to_grey


def channels(picture: np.ndarray, colour: bool) -> Float32[np.ndarray, "h w c"]:
    """Red, green and blue; or one channel of grey, where colour is not asked for or there is none.

    Transparency lies over white. The largest magnitude is 1 whatever the picture's own scale is, so that what is
    squared later neither overflows nor vanishes.
    Raises: PictureError as `check_picture`.
    """
    values = _rgb(picture) if colour and _has_colour(check_picture(picture)) else to_grey(picture)[..., None]
    top = max(float(values.max()), -float(values.min()))
    return np.ascontiguousarray(values / top if top else values, np.float32)


def _has_colour(picture: np.ndarray) -> bool:
    return picture.ndim == 3 and any(np.any(picture[..., 0] != picture[..., other]) for other in (1, 2))


def _rgb(picture: np.ndarray) -> Float32[np.ndarray, "h w 3"]:
    exact = picture if picture.dtype.kind == "f" else picture.astype(np.float32)
    values = np.asarray(exact / full_scale(picture), np.float32)
    return values if values.shape[2] == 3 else 1 - values[..., 3:] * (1 - values[..., :3])
