"""Agents of other programs: in a process of their own (`process`), behind one client file that needs only NumPy."""
