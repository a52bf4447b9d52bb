"""Wind limits of each platform: static limits, and limits found by flying."""
