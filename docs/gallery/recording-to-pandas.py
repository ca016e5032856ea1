from tangible import Mock, Pipeline, Scene

pipeline = Pipeline(Scene.builtin("coins"), depth="luminance", render="proxy")
recording = pipeline.feel(Mock(path="circle"), seconds=2, in_real_time=False)
table = recording.to_pandas()  # a row for each tick
print(table[["x_m", "y_m", "fz_n"]].describe().round(4))
table.plot(x="time_s", y=["fx_n", "fy_n", "fz_n"]).get_figure().savefig("force.png")
# look at: force.png
