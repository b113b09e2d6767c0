"""Sensors of the robot and their noise; the camera and its rendering profiles."""
