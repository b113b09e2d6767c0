"""Demonstrations for imitation, and the comparison of networks that train for the same time."""
