"""The house file format: read, label, check and write a house file.

Imports `sim.geometry` and the base modules of `sim`."""
