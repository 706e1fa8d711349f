"""The results of a run: the contract between the solver, which writes them, and all who read them."""
