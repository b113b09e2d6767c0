"""The Gymnasium environment: world, camera and task in one loop; the shortest-path oracle."""
