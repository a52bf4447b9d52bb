"""The most probable parameters of flights, and what the flights say of each."""
