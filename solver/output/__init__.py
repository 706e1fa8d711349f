"""From the time loop to the results file."""
