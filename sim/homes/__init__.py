"""Homes: generated from a seed, imported from other projects, and their plans for the 2-D environment."""
