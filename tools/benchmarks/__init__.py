"""The parts of `tools/bench.py`; each measures figures against a baseline of the same run."""
