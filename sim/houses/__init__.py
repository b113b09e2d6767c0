"""The house file format: reading, labelling, checking and writing house files."""
