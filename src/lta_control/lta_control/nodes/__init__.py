"""ROS nodes of lta_control."""
