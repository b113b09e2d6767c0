"""The commands `stubborn export ...`."""
