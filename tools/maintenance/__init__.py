"""Assets, the documentation, and type stubs."""
