"""Pages of docs/ that are written from the declarations, so that they cannot be wrong."""
