"""Deprecated: use `sim.app.bridges`."""

from sim.core.deprecation import moved_module

__getattr__ = moved_module(__name__, "sim.app.bridges")
