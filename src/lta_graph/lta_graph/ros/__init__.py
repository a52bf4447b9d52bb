"""The modules that import rclpy, shared by all nodes."""
