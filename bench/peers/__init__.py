"""Ours and its peers on the same clouds, each in a process of its own: a module here for each engine."""
