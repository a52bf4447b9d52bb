"""Cell, solar panel, charger and loads of a vehicle."""
