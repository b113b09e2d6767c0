"""The robot: its one declared configuration, its body as MJCF, how an action is driven, what it touched."""
