"""Garbage during a command: what it imports is no garbage, and is not looked through."""

import json
import subprocess
import sys

PROGRAM = """
import atexit, gc, json, sys
collected = []
gc.callbacks.append(lambda phase, about: phase == "stop" and collected.append(about["generation"]))
atexit.register(lambda: print(json.dumps([collected, gc.get_freeze_count(), len(gc.get_objects())]), file=sys.stderr))
sys.argv[1:] = ["plugins", "--json"]
from tangible_core.cli import main
collected.clear()
main()
"""


def test_command_collects_seldom_and_leaves_its_objects_to_the_end_of_the_process():
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    collected, frozen, others = json.loads(done.stderr.splitlines()[-1])
    assert len(collected) < 3  # 6 by Python's own thresholds
    assert frozen > 100 * others
