"""Connects agents and scripts of other interfaces: those of Habitat, and agents in a process of their own."""
