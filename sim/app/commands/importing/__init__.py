"""Commands that read models from elsewhere: furniture that the user has installed."""
