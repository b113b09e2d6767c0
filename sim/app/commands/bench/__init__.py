"""The parts of `stubborn bench`; each measures figures against a baseline of the same run."""
