"""Tools for developers of this project, run as `python -m tools.research.NAME` from the root of the repository."""
