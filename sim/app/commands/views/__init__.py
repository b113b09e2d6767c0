"""Commands for labelled views: generate shards, draw them, unpack them into files."""
