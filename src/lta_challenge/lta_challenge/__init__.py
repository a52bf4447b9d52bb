"""Flights in which an effect is hidden, and the score of what is found in them."""
