"""What surrounds our code: child processes, standard output, OpenCV, torch."""
