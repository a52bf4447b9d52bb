"""What may stand in each kind of file, as pydantic models."""
