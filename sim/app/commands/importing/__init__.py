"""Commands that read models from elsewhere: furniture and houses."""
