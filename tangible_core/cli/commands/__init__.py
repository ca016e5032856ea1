"""The commands, a file each; `check` is in `plugins`."""
