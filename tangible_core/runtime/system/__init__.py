"""The operating system: processes, files, shared memory, timers, priorities; nothing else asks which it is."""
