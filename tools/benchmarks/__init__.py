"""Benchmarks for maintainers, on pytest-benchmark, and the comparison with another commit."""
