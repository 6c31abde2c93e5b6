"""The running process: progress and compile time."""
