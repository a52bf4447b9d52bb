"""The contents of each kind of file, as pydantic models."""
