"""Force renderers: one method per file, found by entry point."""
