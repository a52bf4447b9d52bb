"""What is real: recorder, player and the links to hardware."""
