"""The mind: the Stubborn agent (Luo et al. 2022), its ablations and baselines. Knows NumPy, never MuJoCo."""
