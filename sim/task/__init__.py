"""The ObjectNav task: start of an episode, success, metrics, causes of failure, trajectories."""
