"""Motors, rotors, and the influence of nearby surfaces on their thrust."""
