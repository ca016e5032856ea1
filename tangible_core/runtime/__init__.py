"""The surroundings of the program: child processes, signals, standard output, threads, OpenCV, torch."""
