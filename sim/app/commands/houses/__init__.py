"""Commands for houses: generate them, check them, write their plans."""
