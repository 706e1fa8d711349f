"""The state at t = 0: joints assembled, velocities consistent, accelerations or equilibrium."""
