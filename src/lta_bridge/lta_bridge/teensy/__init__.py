"""The link to the light board: MAVLink 2 bytes in, blocks of the photodiodes in ROS time out."""
