"""Wind, gusts and turbulence."""
