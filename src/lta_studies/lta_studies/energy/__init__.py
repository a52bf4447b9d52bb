"""Energy studies: power budget, hovering, solar cells, break-even light and panel mounts."""
