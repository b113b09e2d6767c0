"""Builds the report of one run, or of two runs side by side, as one HTML page: `stubborn report RUN_DIR`."""
