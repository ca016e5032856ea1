"""The pipeline: its configuration, the rules of its products, and the engine that makes them."""
