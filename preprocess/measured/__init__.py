"""Parts that were measured: what a test has found, and the superelement of it."""
