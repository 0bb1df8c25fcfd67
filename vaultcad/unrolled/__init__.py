"""The intrados laid flat: maps of deviation, height, intensity and colour, and the way back."""
