"""Hovering for 450 s on identical cells: an airship compared with a multirotor."""
