"""Studies: questions that take many answers of the functions below. They call those functions and hold no physics."""
