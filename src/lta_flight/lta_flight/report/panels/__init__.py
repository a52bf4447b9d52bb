"""The pictures of a flight, one a file; `panels.registry` lists them."""
