from matplotlib import pyplot
from tangible import Mock, Pipeline, Scene

pipeline = Pipeline(Scene.video("waves.mp4"), depth="luminance", render="proxy")
recording = pipeline.feel(Mock(path="circle"), seconds=2, in_real_time=False)  # at a terminal: tangible feel film.yaml
height_mm = 1000 * recording.proxy_m[:, 2]
pyplot.scatter(recording.time_s, height_mm, c=recording.frame, s=4)
pyplot.colorbar(label="frame of the film")
pyplot.gca().set(xlabel="time, s", ylabel="height of the surface under the hand, mm")
pyplot.savefig("film.png")
# look at: film.png
