"""Servers that stand for models which agents reach over HTTP."""
