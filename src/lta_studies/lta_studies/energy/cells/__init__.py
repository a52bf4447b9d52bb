"""Solar cells beside each other: the seed paper's figure, the fair one, and arrays of them."""
