"""The parts of `tools/bench.py`: each measures something against a baseline of the same run."""
