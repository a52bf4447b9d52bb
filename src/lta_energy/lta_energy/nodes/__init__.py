"""ROS nodes of lta_energy."""
