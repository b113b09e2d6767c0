"""Demonstrations of the oracle, and the samples from which the agent `cloned` learns."""
