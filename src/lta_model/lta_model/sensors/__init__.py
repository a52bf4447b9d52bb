"""Models and data sheets of the onboard sensors."""
