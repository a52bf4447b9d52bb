"""ROS nodes of lta_vlc."""
