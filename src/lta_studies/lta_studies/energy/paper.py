"""What the seed paper prints of power, as numbers; what it leaves out has no number here."""

from typing import Final

IDLE: Final = 0.097  # W, stand-by: the controller estimates its state, motors off
TRANSMITTING: Final = 0.120  # W, stand-by and radio
HOVER: Final = 1.333  # W, stabilisation while hovering
NAVIGATION: Final = (1.523, 1.544)  # W, BAG, DES and DGA, not told apart
SHARE: Final = 1.0 / 3.0  # of a standard drone: "almost one third"
STANDARD: Final = HOVER / SHARE  # W, what that makes a standard drone take in hover
HOVER_TIME: Final = 450.0  # s, on identical batteries
