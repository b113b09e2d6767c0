"""The contract of agent and simulator: interface, poses and grids, reading of files, errors, configuration."""
