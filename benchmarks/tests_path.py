"""What the tests share, for benchmarks that measure what the tests check."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1] / "tests" / "helpers"))

import colour_parts as colour_parts
import drawn_parts as drawn_parts
import exported_pictures as exported_pictures
import falcon_bus as falcon_bus
import falcon_streams as falcon_streams
import films as films
import page_files as page_files
import solids as solids
import two_cameras as two_cameras
from faulty_touch import FaultyTouch as FaultyTouch
from loop_devices import Circling as Circling
from loop_devices import Failing as Failing
from rough_surfaces import rough_surfaces as rough_surfaces
