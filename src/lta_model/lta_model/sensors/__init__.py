"""The laws and data sheets of the sensors aboard."""
