"""ROS nodes of lta_energy."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
