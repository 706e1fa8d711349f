"""How past interface loads are remembered: layout, cost and convolution in blocks."""
