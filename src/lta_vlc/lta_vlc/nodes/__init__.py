"""ROS nodes of lta_vlc."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
