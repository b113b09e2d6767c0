"""Connects the simulator to programs that are written for other interfaces: agents and evaluation loops of Habitat."""
