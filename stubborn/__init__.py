"""The Stubborn agent (Luo et al. 2022), its ablations and baselines. Nothing here imports MuJoCo."""
