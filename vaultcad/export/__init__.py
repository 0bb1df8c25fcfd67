"""The files that a `Model` becomes, one module a format; `bundle.write_all` writes them all or none."""
