"""Commands for ROS 2: a robot as a node, an agent as a node, and an environment with the wheels of ROS 2."""
