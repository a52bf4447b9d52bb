"""The wind that each platform can fly in: from its numbers, and by flying."""
