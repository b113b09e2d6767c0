"""The report of a run as one HTML page: `python -m sim.report RUN_DIR`, or two runs side by side."""
