"""A page in the browser: watch an agent live, drive the robot, look at finished runs (`stubborn web`)."""
