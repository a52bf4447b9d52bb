"""ROS nodes of lta_sim."""
