"""The commands, a file each; `check` is with `plugins`."""
