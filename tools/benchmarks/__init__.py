"""Benchmarks for maintainers, on pytest-benchmark."""
