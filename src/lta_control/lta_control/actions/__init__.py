"""The actions of a commanded flight."""
