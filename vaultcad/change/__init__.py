"""What moved: a reading of a vault's deformation, and of the change between two scans."""
