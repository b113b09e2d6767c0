"""Compiled functions (numba) on frames, grids, surfaces and tracks of objects."""
