"""A person at the helm: gamepad, keyboard or Joy messages as setpoints, with instant take-over."""
