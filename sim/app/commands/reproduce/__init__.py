"""The command that runs what the tables of the paper need and writes them."""
