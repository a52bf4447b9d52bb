"""Plain functions compiled by numba and kept on disk."""
