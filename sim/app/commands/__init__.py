"""The user commands of `stubborn`: a module each, with its options `Args` and its function `main`."""
