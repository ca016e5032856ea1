"""Least-squares integration of a field of gradients into a surface."""

import numpy as np
from jaxtyping import Float


def gradient(
    heights: Float[np.ndarray, "h w"],
) -> tuple[Float[np.ndarray, "h w"], Float[np.ndarray, "h w"]]:
    """Return the differences to the next column and to the next row; 0 in the last one, which has no next."""
    return np.diff(heights, axis=1, append=heights[:, -1:]), np.diff(heights, axis=0, append=heights[-1:])


def integrate(x_slope: Float[np.ndarray, "h w"], y_slope: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Return the surface (h, w) of mean zero whose `gradient` is nearest to these slopes by least squares.

    The last column of x_slope and the last row of y_slope are not read. The gradient of a surface gives that surface.
    Source: the Poisson equation with free borders by the cosine transform: Frankot & Chellappa, PAMI 1988, on the
    basis of Simchony, Chellappa & Shao, PAMI 1990.
    """
    from scipy.fft import dctn, idctn

    rows, columns = x_slope.shape
    x = np.concatenate(
        [np.zeros((rows, 1), x_slope.dtype), x_slope[:, :-1], np.zeros((rows, 1), x_slope.dtype)], axis=1
    )
    y = np.concatenate([np.zeros((1, columns), y_slope.dtype), y_slope[:-1], np.zeros((1, columns), y_slope.dtype)])
    spectrum = dctn(np.diff(x, axis=1) + np.diff(y, axis=0), type=2)
    along_y = 2 * np.cos(np.pi * np.arange(rows) / rows)[:, None] - 2
    along_x = 2 * np.cos(np.pi * np.arange(columns) / columns) - 2
    eigenvalue = (along_y + along_x).astype(x_slope.dtype)
    eigenvalue[0, 0] = 1
    spectrum /= eigenvalue
    spectrum[0, 0] = 0
    return np.asarray(idctn(spectrum, type=2))
