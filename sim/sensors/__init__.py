"""What the robot senses: cameras with their rendering profiles, gps and compass."""
