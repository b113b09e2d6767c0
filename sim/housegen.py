"""Deprecated: use `import sim`, which has `generate` and `HouseConfig`, or `sim.homes.housegen`."""

from sim.core.deprecation import moved_module

__getattr__ = moved_module(__name__, "sim.homes.housegen")
