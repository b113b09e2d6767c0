"""The house file format: reading, labelling, checking and writing house files.

Imports `sim.geometry` and the base modules of `sim`."""
