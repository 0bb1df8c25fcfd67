"""Tests that make up their own bad input; `make fuzz` runs them."""
