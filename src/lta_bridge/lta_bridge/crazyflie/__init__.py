"""
The bridge to a Crazyflie: telemetry, commands and the safety state machine.

Only `cflib_link` imports cflib, and only `messages` imports ROS. `links` selects the link by the
scheme of the URI.
"""
