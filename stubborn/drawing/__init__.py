"""Pictures of an agent's map: what it knows, where it goes, and why."""
