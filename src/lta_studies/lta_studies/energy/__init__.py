"""What flights cost: the power budget, hovering against a multirotor, and where panels sit."""
