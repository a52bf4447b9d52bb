"""Read logs of other formats."""
