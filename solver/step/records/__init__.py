"""The records of a time step, a file for each contributor.

A contributor has up to three records: its data (`Bodies`), what a step changes (`BodyState`) and
scratch that lives within a step (`BodyWork`). `system.py` nests them in `System`, `State` and
`Workspace`. A record only declares arrays; `Struct.allocate` makes them, and the sizes of all
dimensions are in lower/allocation.py.

Dimensions:

    n_b         bodies, each with six coordinates: delta x in space, delta Theta in body axes
    n_free      bodies that no constraint holds
    n_f         frames: those that carry couplings or loads first, then those only observed
    n_j         couplings: joints, motions, springs, contacts, stops, motors, couplers
    n_i         rows of all couplings; each has one multiplier
    n_terms     coordinates that couplers add to rows
    n_k         couplings that are contacts
    n_touching  contacts whose events are counted: n_k, and contacts of surfaces
    n_w         couplings that switch: contacts, and those with friction
    n_v         events of contacts that fit into the state
    n_r         couplings with friction
    n_motors    motors
    n_o         joint coordinates that are only observed
    n_d         drives: rows that follow a signal
    n_law       force laws of single rows
    n_h         numbers that force laws remember
    n_l         loads on frames
    n_t         load patterns that carry loads
    n_y         signals of loads, then of load patterns: n_l + n_t
    n_g         load patterns of all bodies, with or without loads
    n_z         channels of sensors
    n_e         flexible bodies
    n_u         elastic dofs of all flexible bodies
    n_a         active dofs: elastic dofs of frames with couplings or loads, of inertia and of q
    n_m         elastic modes
    n_x         springs of Maxwell chains
    n_p         steps whose loads are kept for the convolution
    n_s         coordinates q of second order of all flexible bodies
    n_3q        3 times the largest number of coordinates q of a flexible body
    n_axial     axial forces that are compared with critical loads

A dimension such as `n_i_1` is one longer: item i begins at entry i and ends at entry i + 1. Only
active dofs and load patterns are ever loaded. -1 stands for "none" in arrays of numbers of items.
"""
