"""FMUs that run beside a model: their files, their calls, and their exchange with the time loop."""
