"""The figures of a flight page, one per module; `registry` lists them."""
