"""Method `kornia-gabor`: Gabor energies and k-means in torch."""

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from jaxtyping import Float32, Int32
from pydantic import Field

from tangible_core.data import SegmentMap, to_grey
from tangible_core.runtime import TorchDevice, need, pick_device

from .signal.skipping import Dividing, one_segment

if TYPE_CHECKING:
    from torch import Tensor

    from .energies.gabor_bank import Gabor

# The number of extra clusters to try while some of the requested ones turn out to be seams.
MORE = 3


class KorniaGabor(Dividing):
    """Amplitudes in a bank of Gabor filters, one octave and 30 degrees apart, clustered by k-means; all of it in torch.

    Amplitudes are the roots of the energy in Gaussian windows, standardised over the picture. kornia's `fft_conv`
    applies the filters, at full resolution. Along a boundary a window sees two textures, which can look like a third
    (a seam): an area too narrow for a disc as wide as the window goes to the adjacent segments. Colour is reduced to
    grey. Confidence is 1 - a / b, where a and b are the distances from the nearest centre and the second nearest; 0 in
    a seam.
    Source: Jain & Farrokhnia 1991; Riba et al., Kornia, WACV 2020; Arthur & Vassilvitskii, k-means++, SODA 2007.
    """

    segments: Annotated[int, Field(ge=1, le=64)] | Literal["auto"] = "auto"
    """Number of textures; fewer if there are fewer distinct features. auto: an estimate, at most 8."""
    longest_px: Annotated[float, Field(ge=3, le=512)] = 24.0
    """Longest wavelength, of 2.83, 5.66, 11.3, ... px; limited to 1/16 of the square root of the picture's area."""
    window_px: Annotated[float, Field(ge=1, le=256)] = 12.0
    """Standard deviation of the window over which energy is averaged: at least 0.35 wavelengths, and limited to 1/16 of
    the square root of the picture's area."""
    step_px: Annotated[int, Field(ge=1, le=64)] = 4
    """Side of the square cells that get one feature vector and one label each."""
    restarts: Annotated[int, Field(ge=1, le=100)] = 10
    """Number of runs of k-means; the best one counts."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of the starts of k-means."""
    drop_seams: bool = True
    """Merge strips narrower than two standard deviations of the window to each side into their neighbours."""
    skip_weak: bool = False
    """Drop the weakest filters, keeping 95 % of the energy."""
    skip_octaves: bool = True
    """Drop the shortest wavelengths, below which the picture has less than 0.01 % of its energy."""
    torch_device: TorchDevice = "auto"
    """Device to compute on; `auto` uses a GPU if there is one."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture by texture. Raises: PictureError as `check_picture`, BrokenMethod without torch."""
        need("torch")
        need("kornia")
        from .energies.filter_choice import is_flat, needed_filters
        from .energies.gabor_bank import bank, octaves

        grey = to_grey(picture)
        if is_flat(grey):
            return one_segment(grey.shape)
        most_px = max(1.0, grey.size**0.5 / 16)
        filters = bank(octaves(min(self.longest_px, most_px)))
        return self._segments(grey, needed_filters(grey, filters, self.skip_weak, self.skip_octaves), most_px)

    def _segments(self, grey: Float32[np.ndarray, "h w"], filters: "list[Gabor]", most_px: float) -> SegmentMap:
        from .energies.filter_choice import is_one_texture
        from .kmeans.lloyd import choose_segments, label_map_of_cells
        from .kornia_gabor_kernels import energies, standardise_roots

        window_px = min(self.window_px, most_px)
        planes = energies(grey, filters, self.step_px, window_px, pick_device(self.torch_device))
        if is_one_texture(planes.sqrt().cpu().numpy(), window_px / self.step_px, grey):
            return one_segment(grey.shape)
        rows = standardise_roots(planes)
        count = choose_segments(rows.cpu().numpy(), self.segments, self.seed)
        radius = round(2 * window_px / self.step_px) if self.drop_seams else 0
        labels, trust = self._cluster(rows, tuple(planes.shape[1:]), count, radius)
        return label_map_of_cells(labels, trust, self.step_px, grey.shape)

    def _cluster(
        self, rows: "Tensor", shape: tuple[int, ...], count: int, radius: int
    ) -> tuple[Int32[np.ndarray, "rows columns"], Float32[np.ndarray, "n"]]:
        from .kmeans.lloyd import margins
        from .kornia_gabor_kernels import kmeans
        from .regions.refining import remove_seams

        features, clusters = rows.cpu().numpy(), count
        most = count if self.segments == "auto" else count + MORE
        while True:
            row_labels, centres, _ = kmeans(rows, clusters, self.restarts, self.seed)
            cells = row_labels.cpu().numpy().astype(np.int32).reshape(shape)
            labels, same = remove_seams(cells, radius)
            if labels.max() + 1 >= count or clusters == most:
                return labels, np.where(same.ravel(), margins(features, centres.cpu().numpy()), 0)
            clusters += 1
