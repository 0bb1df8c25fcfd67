"""vaultcad: from laser scans of masonry vaults to BIM-ready parametric solids."""
