"""Deprecated: use `import sim`, which has the names that users need, or `sim.core.configuration`."""

from sim.core.deprecation import moved_module

__getattr__ = moved_module(__name__, "sim.core.configuration")
