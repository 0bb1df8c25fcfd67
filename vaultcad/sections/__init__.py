"""Cuts through scan and model: profiles of the stone, their arcs, and by which rule they may have been drawn."""
