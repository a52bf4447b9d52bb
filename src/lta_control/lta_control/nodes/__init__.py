"""ROS nodes of lta_control."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
