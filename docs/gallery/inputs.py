"""Small files for the gallery's examples: `python inputs.py` writes them into the folder where it is run."""

from pathlib import Path

import cv2
import numpy as np
import skimage.data
from PIL import Image

PIPELINE = """\
scene: builtin/{picture}
want: touch
depth: {{use: luminance}}
workspace: {{relief_m: {relief}}}
render: {{use: proxy}}
device: {{use: mock, path: circle}}
"""

y, x = np.mgrid[-1:1:200j, -1.5:1.5:300j]
areas = np.select([x**2 + (1.3 * y) ** 2 < 0.25, x**2 + (1.3 * y) ** 2 < 0.8], [2, 1], 0)
pictures = {
    "photo.jpg": cv2.resize(skimage.data.coffee(), (300, 200), interpolation=cv2.INTER_AREA),
    "areas.png": np.array([(120, 70, 40), (250, 250, 250), (90, 40, 20)], np.uint8)[areas],
    "map.png": np.array([(60, 110, 200), (90, 170, 80), (60, 110, 200)], np.uint8)[areas],
    **{f"archive/{name}.jpg": getattr(skimage.data, name)()[:200, :300] for name in ("coins", "brick", "moon")},
}
for side, view in zip(("left", "right"), skimage.data.stereo_motorcycle(), strict=False):
    pictures[f"{side}.png"] = cv2.resize(view, (370, 250), interpolation=cv2.INTER_AREA)
Path("archive").mkdir(exist_ok=True)
for name, picture in pictures.items():
    Image.fromarray(picture).save(name)

rough = np.fft.fft2(np.random.default_rng(5).normal(size=(120, 180)))
cycles = np.hypot(*np.meshgrid(np.fft.fftfreq(120, 1 / 120), np.fft.fftfreq(180, 1 / 180), indexing="ij"))
cv2.imwrite("mountains.tif", np.fft.ifft2(rough / np.maximum(cycles, 1) ** 2).real.astype(np.float32))

film = cv2.VideoWriter("waves.mp4", cv2.VideoWriter.fourcc(*"mp4v"), 20, (160, 120))
for frame in range(40):
    wave = 128 + 100 * np.sin(np.hypot(*np.mgrid[-60:60, -80:80]) / 8 - frame * np.pi / 10)
    film.write(wave.astype(np.uint8)[..., None].repeat(3, 2))
film.release()

for name, picture, relief in (("coins", "coins", "4 mm"), ("brick", "brick", "4 mm"), ("steep", "coins", "15 mm")):
    Path(f"{name}.yaml").write_text(PIPELINE.format(picture=picture, relief=relief))
