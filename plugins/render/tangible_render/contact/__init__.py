"""Contact of the proxy: entry, the nearest point, spring and damper."""
