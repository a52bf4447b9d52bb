"""ROS nodes of lta_sim."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
