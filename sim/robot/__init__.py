"""The robot: its configuration, its body as MJCF, the controller of its actions, and its contacts."""
