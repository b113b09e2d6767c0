"""What makers of this project need, run as `python -m tools.research.NAME` from the root of the repository."""
