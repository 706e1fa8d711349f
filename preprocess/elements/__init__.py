"""Element matrices: beams and solids."""
