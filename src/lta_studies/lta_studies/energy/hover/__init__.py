"""Hovering for 450 s on identical cells: a drone that gas carries, and one that nothing does."""
