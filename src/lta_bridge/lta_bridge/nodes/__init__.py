"""ROS nodes of lta_bridge."""
