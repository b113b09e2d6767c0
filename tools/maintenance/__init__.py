"""Assets, benchmarks against other versions, the documentation and its pictures."""
