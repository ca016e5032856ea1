"""The usual recipe with OpenCV alone: a bank of Gabor filters, smoothed magnitudes, k-means."""

import cv2
import numpy as np

WAVELENGTHS_PX = tuple(2 * 2**0.5 * 2**i for i in range(5))
ORIENTATIONS = 6
SIGMA, GAMMA = 0.56, 0.5
"""Standard deviation of the Gaussian over the wavelength (one octave), and its width over its height."""
WINDOW = 1.5  # standard deviation of the smoothing over the wavelength
ATTEMPTS, ROUNDS, STILL = 3, 20, 0.1
RECIPE = (
    "`cv2.getGaborKernel` in 6 orientations x 5 wavelengths from 2 sqrt 2 to 45 px by octaves (sigma 0.56 wavelengths, "
    "gamma 0.5, psi 0 and -90 degrees), each 1 in the sum of magnitudes and the even one without its mean; "
    "`cv2.filter2D` of float32 grey; the magnitude of both; `cv2.GaussianBlur` with sigma 1.5 wavelengths; each "
    "feature less its mean over its standard deviation; `cv2.kmeans` of all pixels with k given, k-means++ starts, "
    "the best of 3, at most 20 rounds or a move below 0.1; no coordinates"
)
"""As MATLAB's documented example "Texture Segmentation Using Gabor Filters" has it, with the orientations of Jain &
Farrokhnia 1991, and without its coordinates, as a texture may lie in several places."""


def segmented(grey: np.ndarray, segments: int) -> np.ndarray:
    """Labels of a uint8 picture, int32 (h, w)."""
    values = grey.astype(np.float32)
    planes = [
        cv2.GaussianBlur(_magnitude(values, *pair), (0, 0), WINDOW * wavelength_px, borderType=cv2.BORDER_REFLECT)
        for wavelength_px in WAVELENGTHS_PX
        for pair in _kernels(wavelength_px)
    ]
    features = np.stack(planes, axis=2).reshape(-1, len(planes))
    features = (features - features.mean(axis=0)) / features.std(axis=0)
    cv2.setRNGSeed(0)
    until = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, ROUNDS, STILL)
    _, labels, _ = cv2.kmeans(features, segments, None, until, ATTEMPTS, cv2.KMEANS_PP_CENTERS)
    return labels.reshape(grey.shape)


def _magnitude(values: np.ndarray, even: np.ndarray, odd: np.ndarray) -> np.ndarray:
    parts = (cv2.filter2D(values, cv2.CV_32F, kernel, borderType=cv2.BORDER_REFLECT) for kernel in (even, odd))
    return cv2.magnitude(*parts)


def _kernels(wavelength_px: float) -> list[tuple[np.ndarray, np.ndarray]]:
    found = []
    for i in range(ORIENTATIONS):
        theta = i * np.pi / ORIENTATIONS
        even, odd = (
            cv2.getGaborKernel((0, 0), SIGMA * wavelength_px, theta, wavelength_px, GAMMA, psi, cv2.CV_32F)
            for psi in (0.0, -np.pi / 2)
        )
        found.append(((even - even.mean()) / np.abs(even).sum(), odd / np.abs(odd).sum()))
    return found
