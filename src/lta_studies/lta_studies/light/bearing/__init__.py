"""How well a drone knows the direction to a lamp: ours beside the paper's."""
