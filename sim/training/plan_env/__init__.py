"""The 2-D twin of the environment: agents of `stubborn` in house plans, for training and for tests of explorers."""
