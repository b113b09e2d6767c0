"""Running many episodes: one episode, workers, executors, result files, and intervals over houses.

Imports viewers, env and the rooms below them."""
