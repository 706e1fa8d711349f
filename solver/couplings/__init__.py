"""Couplings between bodies: joints, motions, springs, contacts, stops, motors, couplers."""
