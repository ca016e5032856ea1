"""Segments by texture: Gabor energies and binary patterns, clustered without chance."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tangible_core.data import SegmentMap, check_picture

from .signal.skipping import Dividing, one_segment


class Gabor(Dividing):
    """Clusters of Gabor energies: one texture per segment, whatever its brightness, in one place or several.

    For pictures of materials, such as bark, brick and cloth side by side: each texture becomes one material, wherever
    it lies. In a photograph of things take `hierarchy`, whose regions are those that people would draw.

    >>> import numpy as np
    >>> from tangible import Gabor
    >>> rows, columns = np.mgrid[:128, :128]
    >>> stripes = np.where(columns < 64, np.sin(columns), np.sin(rows))
    >>> Gabor(segments=2).segment(np.uint8(127 + 100 * stripes)).labels[64, [8, 120]].tolist()
    [0, 1]

    The features are local energies in a bank of Gabor filters and frequencies of local binary patterns, in cells of
    4 x 4 pixels; a small network, fitted to many other textures, adds values in pictures of 256 pixels a side or more.
    Cells are divided into many clusters, and the two that differ least are joined, again and again, until the next two
    are likely to be two textures. Flat areas are told apart by tone. The result is deterministic and does not depend on
    the picture's origin. Labels are in the order of their first pixels, row by row. Confidence is 1 - q / p, where p
    and q are the memberships of a pixel's class and of the second best class: 0 on borders.
    Sources: Jain & Farrokhnia, Pattern Recognition 24, 1991 (the energies); Ojala et al., IEEE TPAMI 24, 2002
    (patterns); Su & Dy, ICTAI 2004 (division); Ward, J. Am. Stat. Ass. 58, 1963 (joining).
    """

    segments: Annotated[int, Field(ge=1, le=64)] | Literal["auto"] = "auto"
    """Largest number of textures; `auto`: an estimate, at most 16, told with its confidence and the next best."""
    effort: Literal["fast", "balanced"] = "balanced"
    """`fast` starts from fewer clusters, recomputes the discriminating features less often, and uses no network."""
    colour: bool | Literal["auto"] = "auto"
    """Add two colour channels to the texture features; `auto`: where windows of the picture differ in colour."""
    lambda_max_px: Annotated[float, Field(ge=2.8, le=512)] = 24.0
    """Longest wavelength of the filters, which are octaves from 2.8 pixels."""
    least_energy: Annotated[float, Field(ge=0, lt=1)] = 1e-3
    """Filters with less than this fraction of the total energy are dropped; 0 keeps all of them."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture by texture, in 64 bytes a pixel and 16 MiB. Raises: PictureError as `check_picture`."""
        from .clusters.classes import LARGEST_NUMBER, classes
        from .clusters.flat_areas import flat_areas
        from .clusters.full_size import fine_memberships, pixel_labels
        from .clusters.planes import combine_planes
        from .features.cells import CELL_PX
        from .features.features import Window, features
        from .learned.network import learned_values
        from .regions.merging import number_in_reading_order

        if self.segments == 1:
            return one_segment(check_picture(picture).shape[:2])
        most = LARGEST_NUMBER if self.segments == "auto" else self.segments
        flat = flat_areas(picture, self.colour is not False, most)
        if flat is not None:
            return SegmentMap(number_in_reading_order(flat))
        windows = features(picture, self.lambda_max_px, self.least_energy, self.colour)
        if windows is None:
            return one_segment(picture.shape[:2])
        network_window = learned_values(windows) if self.effort == "balanced" else None
        labels, axes = classes(windows, network_window, self.segments, self.effort)
        if not labels.any():
            return one_segment(picture.shape[:2])
        narrow, middle = (
            Window(combine_planes(axes, window.planes), window.shape) for window in (windows.narrow, windows.middle)
        )
        memberships = fine_memberships(middle, labels, narrow)
        pixels, confidence = pixel_labels(memberships, CELL_PX, picture.shape[:2])
        return SegmentMap(number_in_reading_order(pixels), confidence)
