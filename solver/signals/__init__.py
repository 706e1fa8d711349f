"""Functions of time: what drives joints and motions, and what loads and motors follow."""
