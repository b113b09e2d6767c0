"""Experiments: the 2-D environment against the real one, explorers in plans, drawings of paths and potentials."""
