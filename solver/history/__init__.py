"""The history of interface loads: its layout, its cost, and convolution in blocks."""
