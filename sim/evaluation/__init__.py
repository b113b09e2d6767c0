"""Running many episodes: rollout of one, workers, executors, result files.

Imports viewers, env and the rooms below them."""
