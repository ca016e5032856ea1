"""The pipeline as a program has it; its file, the engine that makes its products, and its output."""
