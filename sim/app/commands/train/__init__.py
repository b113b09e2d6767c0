"""Commands that train and fit: networks, explorers, verifiers, and the fusion of views."""
