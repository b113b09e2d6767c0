"""The ObjectNav task: start of an episode, success, metrics, causes of failure, trajectories.

Imports world and the rooms below it."""
