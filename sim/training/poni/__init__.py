"""Potentials of plans, from which the explorer `poni` learns."""
