"""Texture: every promise with its bound, and what stands behind the figures.

TANGIBLE_TEXTURES names folders with pictures of one texture each; the first has eight or more that no method was tuned
on. Without it, mosaics of the builtin textures stand in for them.
"""

from . import texture_gradient, texture_growth, texture_opencv, texture_scenes, texture_unseen
from .figures import judged, part

PROTOCOL = (
    "Methods are told the number of segments unless it says otherwise. Times are ratios in the same process, geometric "
    "mean of the mosaics. ARI is the adjusted Rand index, "
    "accuracy the share of right pixels after the best matching of labels, boundary the mean distance of borders both "
    "ways (docs/how-to/compare.md). Every texture has lost its local mean and contrast, and all have one histogram."
)


def section() -> str:
    """Return the section as Markdown."""
    figures = part("mosaics of two halves", texture_unseen.figures)
    figures += part("smooth scenes", texture_gradient.figures)
    growth, sizes = part("growth", texture_growth.measured)
    return "\n".join(
        [
            *_conditions(),
            "",
            *judged([*figures, *growth]),
            "",
            "By kind of region, mosaics of two halves of the textures, of 2 to 16 segments.",
            "",
            *texture_unseen.kind_rows(),
            "",
            "`gabor` on one mosaic, cut or mirrored over and over.",
            "",
            *sizes,
        ]
    )


def _conditions() -> list[str]:
    given = (
        "Held out: mosaics of photographs of textures; the others are of brick, grass, gravel, and textures in code."
        if texture_scenes.folders()
        else f"{texture_scenes.FOLDER} was not set: the builtin textures stand in for those held out."
    )
    return [
        f"Mosaics of {texture_scenes.SIDE_PX} x {texture_scenes.SIDE_PX}. {given} {PROTOCOL}",
        "",
        f"OpenCV's recipe: {texture_opencv.RECIPE}. scikit-image's: {texture_gradient.RECIPE}.",
    ]
