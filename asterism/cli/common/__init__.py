"""Common parts of all commands: options, skeleton of a run, progress, the last line."""
