"""ROS 2 messages of an episode: their definitions, and how observations and poses become messages."""
