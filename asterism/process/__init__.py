"""The running process: interruption and compile time."""
