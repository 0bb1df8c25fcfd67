"""OpenCASCADE, as far as it is asked things of its own."""
