"""What all commands share: options, run skeleton, progress, the last line."""
