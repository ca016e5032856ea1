# tangible compare semi-global zncc ssd opencv-sgbm --set 'scenes=[synthetic/planes]' --quick --out out/pareto
import pandas
from matplotlib import pyplot

for row in pandas.read_csv("out/pareto/table.csv").itertuples():
    pyplot.loglog(1000 * row.seconds, row.bad2, "o", label=row.method)
pyplot.gca().set(xlabel="time, ms", ylabel="pixels off by more than 2 px, %")
pyplot.legend()
pyplot.savefig("pareto.png")
# look at: pareto.png
