"""Teleoperation by gamepad, keyboard or Joy messages, with instant take-over."""
