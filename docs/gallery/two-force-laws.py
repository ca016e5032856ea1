from matplotlib import pyplot
from tangible import Mock, Penalty, Pipeline, Proxy, Scene

pipeline = Pipeline(Scene.builtin("coins"), depth="luminance", render=Proxy())
for law in (Proxy(), Penalty()):
    recording = pipeline.with_(render=law).feel(Mock(path="circle"), seconds=2, in_real_time=False)
    pyplot.plot(recording.time_s, recording.force_n[:, 2], label=type(law).__name__)
pyplot.gca().set(xlabel="time, s", ylabel="force upwards, N")
pyplot.legend()
pyplot.savefig("laws.png")
# look at: laws.png
