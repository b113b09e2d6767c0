"""Training of every learned part: views, samples, trainers and fits. Nothing that runs an episode needs it."""
