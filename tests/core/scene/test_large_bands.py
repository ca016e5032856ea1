"""If one of these fails, a picture that is reduced band by band is felt with wrong pixels at its rims, or cut short."""

import numpy as np
import pytest

from tangible_core.scene.formats.bands import reduced


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.int32])
@pytest.mark.parametrize("channels", [(), (3,)])
@pytest.mark.parametrize("shape", [(12, 15), (10, 11), (11, 13), (1, 1), (2, 14)])
@pytest.mark.parametrize("high", [1, 4, 100])
def test_squares_at_the_right_and_lower_rim_are_cut_short(
    shape: tuple[int, int], channels: tuple[int, ...], dtype: type, high: int
):
    picture = np.random.default_rng(0).integers(0, 200, (*shape, *channels)).astype(dtype)
    bands = (picture[first : first + high] for first in range(0, shape[0], high))
    found = reduced(bands, *shape, 3)
    rim = [(0, -side % 3) for side in shape] + [(0, 0)] * len(channels)
    whole = np.pad(picture.astype(np.float64), rim, mode="edge")
    rows, columns = whole.shape[0] // 3, whole.shape[1] // 3
    means = whole.reshape(rows, 3, columns, 3, *channels).mean(axis=(1, 3))
    assert found.dtype == dtype
    assert found.shape == means.shape
    assert np.abs(found - means).max() <= (1e-4 if dtype is np.float32 else 1)


def test_rows_that_are_missing_are_told():
    with pytest.raises(ValueError, match="its rows end early"):
        reduced([np.zeros((6, 5), np.uint8)], 7, 5, 3)
