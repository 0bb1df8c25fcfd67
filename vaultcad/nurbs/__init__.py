"""The paper's first route: surfaces through the profiles of the scan, without a family."""
