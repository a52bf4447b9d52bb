"""Generate flights with hidden effects and score what discovery finds in them."""
