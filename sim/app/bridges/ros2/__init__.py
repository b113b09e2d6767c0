"""A robot of the simulator as a node of ROS 2, and agents of this project as nodes that drive any robot over topics."""
