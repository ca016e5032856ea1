"""A batch in a process of its own, which says what it took: `python -m benchmarks.batch_client CONFIG MANIFEST ...`."""

import json
import resource
import sys
import time
from pathlib import Path

import psutil

from tangible_batch.manifest import find_rows
from tangible_batch.results import last_rows, write_gallery, write_index
from tangible_batch.running import BatchOptions, Workforce, run_batch


def main(config: Path, manifest: Path, out: Path, workers: int, first: int) -> None:
    """Print what it took, as JSON."""
    own = psutil.Process()
    marks = [mark for mark in (first, 1000, 5000) if mark > 0]
    text, who = config.read_text(), Workforce(workers, threads=1)
    client_mb, worker_mb, reached, failed = [], [], [], 0
    since_s = half_s = time.monotonic()
    from_s = 0
    rows = run_batch(text, config, find_rows(str(manifest)), out, who, BatchOptions())
    total = manifest.read_text().count("\n") - 1
    for seen, row in enumerate(rows, 1):
        failed += row["outcome"] != "ok"
        if seen == min(first, total // 4):  # all workers have compiled by then
            half_s, from_s = time.monotonic(), seen
        if seen in marks or seen == total:
            reached.append(seen)
            client_mb.append(own.memory_info().rss / 1e6)
            worker_mb.append(max(child.memory_info().rss for child in own.children(recursive=True)) / 1e6)
    end_s = time.monotonic()
    used = time.process_time()
    names = [scene.id for scene in find_rows(str(manifest))]
    write_index(out, names)
    write_gallery(out, names)
    times, peak = resource.getrusage(resource.RUSAGE_CHILDREN), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    said = {
        "failed": failed + total - len(set(last_rows(out))),
        "client_s": used,
        "workers_s": times.ru_utime + times.ru_stime,
        "client_mb": client_mb,
        "client_peak_mb": peak / 1e3,
        "worker_mb": worker_mb,
        "marks": reached,
        "whole_s": end_s - since_s,
        "steady_s": (end_s - half_s) / (total - from_s),
    }
    print(json.dumps(said))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4]), int(sys.argv[5]))
