"""Motors, rotors, and what surfaces near them do to their thrust."""
