"""Commands that write recorded runs in the formats of other projects."""
