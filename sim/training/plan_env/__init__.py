"""The 2-D environment: house plans with the interface of Gymnasium, for training explorers and policies."""
