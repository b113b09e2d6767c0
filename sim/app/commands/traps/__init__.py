"""Commands for the trap scenes: make them, report which agent escapes from which trap."""
