"""Running many episodes: one episode, workers, executors, result files, and intervals over houses."""
