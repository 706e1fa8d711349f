"""Records of contacts of surfaces: of flexible bodies, by their nodes, against shapes.

The code is in step/surfaces.py and step/complementarity.py.
"""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Patches(Struct):
    """Surfaces in contacts: their nodes, rows and points of integration, patch by patch.

    A row belongs to a corner of facets; with w of a point, dual functions psi and shape functions N

        y_i = 1/A_i sum_q w_q psi_i(q) g_q,   A_i = sum_q w_q psi_i(q),   x_q = sum_k N_k(q) x_k
    """

    body: Index = array("n_patches")
    """body of each patch, -1: it is fixed in space"""
    owner: Index = array("n_patches")
    """`SurfaceBodies` of each patch, -1: it is rigid, and its nodes are in the axes of a frame"""
    node: Index = array("n_patches_1")
    """first node of each patch"""
    row: Index = array("n_patches_1")
    """first row of each patch"""
    point: Index = array("n_patches_1")
    """first point of each patch"""
    center: Array = array("n_patches", 3)
    """center of a sphere around the patch, in the axes of its nodes [m]"""
    radius: Array = array("n_patches")
    """its radius [m]"""
    ball_range: Index = array("n_patches_1")
    """first entry of each patch in `ball`"""
    ball: Array = array("n_balls", 4)
    """centers of spheres around parts of each patch, in the axes of its nodes, and radii [m]"""
    X: Array = array("n_nodes", 3)
    """nodes from the center of mass in body axes, or from the origin of a frame in its axes [m]"""
    area: Array = array("n_rows")
    """A_i of rows that are wholly covered [m^2]"""
    weight: Array = array("n_points")
    """w of each point [m^2]"""
    N: Array = array("n_points", 9)
    """shape functions of the nodes of the facet at each point"""
    corner: Array = array("n_points", 4)
    """linear shape functions L of its corners there"""
    dual: Array = array("n_points", 4)
    """dual functions psi of its corners there, of a facet that is wholly covered"""
    around_range: Index = array("n_rows_1")
    """first entry of each row in `around`"""
    around: Index = array("n_around", 2)
    """facets around each row, and which of their corners it is"""
    slot: Index = array("n_around", 9)
    """place of each node of such a facet in `support`, from the first of the row on"""
    support_range: Index = array("n_rows_1")
    """first entry of each row in `support`"""
    support: Index = array("n_supports")
    """nodes of the facets around each row"""


class Facets(Struct):
    """The facets of patches, patch by patch."""

    range: Index = array("n_patches_1")
    """first facet of each patch"""
    kind: Index = array("n_patches")
    """type of the facets of each patch, by its number in step/facets.py"""
    shaped: Index = array("n_patches")
    """type of their shapes as targets: smooth facets have middle nodes"""
    corners: Index = array("n_patches")
    """corners of each facet"""
    n_nodes: Index = array("n_patches")
    """nodes of each facet"""
    points: Index = array("n_patches")
    """points of integration of each facet"""
    nodes: Index = array("n_facets", 9)
    """nodes of each facet, corners first"""
    rows: Index = array("n_facets", 4)
    """rows of its corners"""
    beside: Index = array("n_facets", 4)
    """facet that shares the edge from this corner to the next, -1: none does"""
    rise: Array = array("n_facets", 4)
    """height of the arc from this corner to the next above its chord [m]"""
    around_range: Index = array("n_facet_corners_1")
    """first entry of each corner of each facet, four of each, in `around`"""
    around: Index = array("n_turned")
    """facets of which the mean normal is that of the corner"""


class SurfaceBodies(Struct):
    """The elastic motion of the surfaces of flexible bodies.

    At their nodes, with free motion eta of the modes, displacements u of the active dofs and their
    history, and forces f of the contacts:

        u_C = phi eta + T (u - history) + G f + B s
        T = G_CJ G_JJ^-1,   G = G_CC - T G_JC,   G_CC = phi (beta h^2 / S) phi^T + F

    s: amplitudes of load patterns; the modes of the file have all of their static response, so that
    B = G_CP - T G_JP has no rest of its own.
    """

    flexible: Index = array("n_bodies")
    """flexible body of each"""
    island: Index = array("n_bodies")
    """island of each"""
    node: Index = array("n_bodies_1")
    """first node of each"""
    phi: Array = array("n")
    """shapes (3 n, m) at the nodes of the modes of files, not split into shares, one body after the
    other; bodies may share one"""
    phi_start: Index = array("n_bodies")
    """first entry of each body in `phi`"""
    T: Array = array("n")
    """displacements (3 n, n_a) by those of the active dofs, one body after the other"""
    T_start: Index = array("n_bodies")
    """first entry of each body in `T`"""
    G: Array = array("n")
    """compliances (3 n, 3 n) with the active dofs held, one body after the other"""
    G_start: Index = array("n_bodies")
    """first entry of each body in `G`"""
    A: Array = array("n")
    """second order (3 n, r, r) by the coordinates q, one body after the other"""
    A_start: Index = array("n_bodies")
    """first entry of each body in `A`"""
    slope: Index = array("n_bodies_1")
    """first of the slopes A q (3 n, r) of each body"""
    reach: Array = array("n_bodies")
    """largest displacement of a node per root of the strain energy of the modes [m/sqrt(J)]"""
    second_reach: Array = array("n_bodies")
    """largest displacement of second order of a node per square of q"""
    source_range: Index = array("n_bodies_1")
    """first mode of each body in `SurfaceWork.source`: those of the file, then those of the rest"""
    recorded: Index = array("n_bodies_1")
    """first mode of the file of each body in results"""
    source: Index = array("n_m")
    """mode of the file that each mode is a share of, of bodies of surfaces alone"""
    share: Array = array("n_m")
    """root of this share: times it coordinates sum up to that of the source"""
    spread: Array = array("n")
    """B: displacements (3 n,) by each load pattern at amplitude 1, with the active dofs held"""
    spread_start: Index = array("n_t")
    """first entry of each load pattern in `spread`; -1: no surface of its body is in contact"""
    spread_reach: Array = array("n_t")
    """largest displacement of a node by each load pattern at amplitude 1"""


class SurfaceContacts(Struct):
    """Contacts of patches, which have the rows, with shapes or with other patches."""

    patch: Index = array("n_contacts")
    """patch that has the rows of each contact"""
    target: Index = array("n_contacts")
    """patch that it meets, -1: a shape"""
    frame: Index = array("n_contacts")
    """frame that carries the shape or the rigid patch, -1: the target is flexible"""
    shape: Index = array("n_contacts")
    """number of the shape"""
    side: Array = array("n_contacts")
    """1: outside of the shape, -1: inside"""
    axis: Array = array("n_contacts", 3)
    """axis of the shape, in the axes of its frame"""
    across: Array = array("n_contacts", 3)
    """axis across it, in the axes of its frame"""
    first: Index = array("n_contacts_1")
    """first parameter of each shape"""
    parameters: Array = array("n_parameters")
    """parameters of the shapes"""
    size: Array = array("n_contacts")
    """depth at which a point is no longer below the target but beyond it [m]"""
    margin: Array = array("n_contacts")
    """gap below which a row may close in a step [m]; not a number: twice its motion in the step"""
    layer: Array = array("n_contacts")
    """compliance of a layer, per area [m^3/N]; 0: none"""
    row: Index = array("n_contacts_1")
    """first row of each contact, among those of all contacts"""
    slip_row: Index = array("n_contacts")
    """first row of slips, along the first and then along the second tangents, of each contact with
    friction; these follow the rows of all contacts; -1: there is no friction"""
    friction: Array = array("n_contacts", 3)
    """static and sliding coefficient of friction, and the speed of slip at which it falls"""
    start: Index = array("n_contacts")
    """first place of each contact with friction in `SurfaceWork.start`"""
    support: Index = array("n_contacts_1")
    """first support of each contact, among those of all contacts"""
    other: Index = array("n_all_rows_1")
    """first place of each row in the lists of nodes of targets"""
    island_range: Index = array("n_islands_1")
    """first entry of each island in `island`"""
    island: Index = array("n_contacts")
    """contacts by island: those that share flexible bodies are solved for together"""
    coordinate: Index = array("n_contacts", 2)
    """first coordinate, among those of the island, of the body of the patch and of that of the
    target; -1: the target is fixed in space"""
    body_range: Index = array("n_islands_1")
    """first entry of each island in `body`"""
    body: Index = array("n_island_bodies")
    """bodies of each island"""
    body_coordinate: Index = array("n_island_bodies")
    """first coordinate of each among those of its island"""
    body_width: Index = array("n_island_bodies")
    """number of coordinates of each"""
    coordinates: Index = array("n_islands")
    """number of coordinates of each island"""
    stiffness_start: Index = array("n_islands")
    """first number of each island in `SurfaceWork.stiffness`"""
    block_range: Index = array("n_islands_1")
    """first block of each island in `Pattern.island_block`"""


class Surfaces(Struct):
    """Contacts of surfaces, and what is known of these."""

    patches: Patches
    facets: Facets
    bodies: SurfaceBodies
    contacts: SurfaceContacts


class SurfaceState(Struct):
    """What a step takes from the one before about contacts of surfaces."""

    force: Array = array("n_all_rows")
    """normal force of each row, and friction of each slip [N]"""
    gap: Array = array("n_all_rows")
    """weighted gap y of each row, and slips in the last step [m]; not a number: not known"""
    load: Array = array("n_nodes", 3)
    """forces on the nodes, in body axes [N]"""
    u: Array = array("n_nodes", 3)
    """elastic displacements of the nodes of bodies near a contact, in body axes [m]"""
    modal_load: Array = array("n_m")
    """loads of contacts on the modes"""
    normal: Array = array("n_all_rows", 3)
    """mean normal of each row, in body axes"""
    normal_force: Array = array("n_contacts")
    """sum of the forces of the rows of each contact [N]"""
    total_force: Array = array("n_contacts", 3)
    """force of each contact on the body of its rows, in space [N]"""
    total_moment: Array = array("n_contacts", 3)
    """moment of it about the center of mass of that body, in space [N m]"""
    center: Array = array("n_contacts", 3)
    """center of pressure of each contact that is closed, in space [m]"""


class SurfaceWork(Struct):
    """Scratch of contacts of surfaces."""

    looks: Index = array(1)
    """iterates of this step at which tangent planes were laid; -1: contacts do not act yet"""
    held: Index = array(1)
    """1: a search for an equilibrium says which rows are closed, and what is closed sticks"""
    near: Index = array("n_contacts")
    """1: the patch may meet the shape in this step"""
    awake: Index = array("n_bodies")
    """1: `free` is known for this step"""
    v_n: Array = array("n_b", 6)
    """velocities of bodies at the start of the step, as in `BodyState.v`"""
    eta_n: Array = array("n_m")
    """modal coordinates at the start of the step"""
    force_n: Array = array("n_all_rows")
    """`SurfaceState.force` at the start of the step [N]"""
    gap_n: Array = array("n_contact_rows")
    """their gaps there [m]"""
    modal_load_n: Array = array("n_m")
    """loads of contacts on the modes at the start of the step"""
    source: Array = array("n_sources")
    """coordinates of the modes of files, sums of those of their shares"""
    source_load: Array = array("n_sources")
    """loads of contacts on these modes"""
    modal_step: Array = array("n_m")
    """modal coordinates that the loads of contacts cause within the step"""
    free: Array = array("n_nodes", 3)
    """displacements of the nodes by the free motion of the modes [m]"""
    base: Array = array("n_nodes", 3)
    """displacements of the nodes without the forces of contacts, in body axes [m]"""
    by_load: Array = array("n_nodes", 3)
    """displacements G f of the nodes by the forces of contacts, in body axes [m]"""
    place: Array = array("n_nodes", 3)
    """positions of the nodes of one contact, in the axes of its target [m]"""
    start: Array = array("n_start_places", 3)
    """these of contacts with friction at the start of the step, contact by contact: those of the
    patch, then those of its target [m]"""
    kind: Index = array("n_islands", "n_most_rows")
    """0: the candidate is a gap, 1, 2: a slip along the first or second tangent"""
    mu: Array = array("n_most_rows", 3)
    """friction of the candidates, see step/cone.py"""
    law: Array = array("n_most_rows", 6)
    """their law, see there"""
    pivots: Index = array("n_most_rows")
    """pivots of its factors"""
    made: Index = array("n_islands", "n_most_rows")
    """status of the candidates for which these factors were made, -1: there are none"""
    trial: Array = array("n_most_rows")
    """corrections of forces there"""
    facet_place: Array = array("n_facets", 9, 3)
    """positions of the nodes of facets of a target, with middle nodes of smooth ones [m]"""
    facet_normal: Array = array("n_facets", 3)
    """normals of these facets, as long as twice their areas [m^2]"""
    corner_normal: Array = array("n_facets", 4, 3)
    """unit normals at their corners"""
    facet_low: Array = array("n_facets", 3)
    """lower corners of boxes around them [m]"""
    facet_high: Array = array("n_facets", 3)
    """upper corners of these boxes [m]"""
    facet_axes: Array = array("n_facets", 3, 3)
    """axes of facets: along the first edge, across it, and the normal"""
    facet_from: Array = array("n_facets", 3)
    """least coordinates of their nodes along these, from the first node [m]"""
    facet_to: Array = array("n_facets", 3)
    """largest ones [m]"""
    block_low: Array = array("n_facets", 3)
    """lower corners of boxes around blocks of facets, at the first of each [m]"""
    block_high: Array = array("n_facets", 3)
    """upper corners of these boxes [m]"""
    N: Array = array(9)
    """shape functions of a facet"""
    dN: Array = array(2, 9)
    """their derivatives"""
    plane: Array = array("n_most_points", 4)
    """tangent plane of each point of one contact, normal and offset, in the axes of its target"""
    foot: Index = array("n_most_points")
    """facet of the target below each point that is covered"""
    foot_N: Array = array("n_most_points", 9)
    """shape functions of its nodes there"""
    gap: Array = array("n_most_points")
    """gaps of the points [m]"""
    point_N: Array = array("n_most_points", 9)
    """shape functions of the nodes of its facet at each point of one contact, or in the middle of
    the covered part of its cell"""
    point_L: Array = array("n_most_points", 4)
    """linear shape functions of the corners there"""
    cover: Array = array("n_most_points")
    """part of the cell of each point that the target covers"""
    weight: Array = array("n_most_points", 4)
    """w psi of the corners of the facet of each point, 0 where it is not covered [m^2]"""
    node_gap: Array = array("n_nodes")
    """gaps of the nodes of one contact [m]; not a number: not known"""
    row_gap: Array = array("n_contact_rows")
    """bounds from below of the gaps of its rows [m]"""
    below: Index = array("n_facets")
    """facet of the target below the center of each facet, -1: none"""
    is_far: Index = array("n_facets")
    """1: the facet is too far from its target to be looked at"""
    rim: Array = array(4, 3)
    """unit vectors across the edges of a target that cut the cell of one point; 0: it does not"""
    tangent: Array = array(2, 3)
    """tangents of a facet at one point"""
    slope_L: Array = array("n_most_points", 2, 4)
    """derivatives of `point_L` by the reference coordinates, of points whose cell is cut"""
    slope_gap: Array = array("n_most_points", 2)
    """derivatives of the gap by them [m]"""
    by_motion: Array = array("n_most_points", 3, 3)
    """gradients of `cover` and of these coordinates by the motion of the point over its target
    [1/m]"""
    apart: Array = array("n_most_points", 3)
    """from the nodes below the middle of such a cell to it [m]"""
    by_rim: Array = array("n_most_points", 4, 3, 2)
    """derivatives of sums of gaps and of areas, see step/weights.py"""
    mean_gap: Array = array("n_contact_rows")
    """weighted gaps of the rows [m]"""
    sums: Array = array(2, 4)
    """D and G of one facet, see there"""
    summed: Array = array(4)
    """D h of one facet"""
    M: Array = array(4, 8)
    """matrix of the dual functions of one facet, and its inverse times D"""
    area: Array = array("n_contact_rows")
    """A_i of the covered part of each row [m^2]"""
    facing: Array = array("n_contact_supports", 3)
    """gradient of the gap of a row by the motion of each node around it, in the axes of its
    target"""
    offset: Array = array("n_all_rows")
    """gap of a row less the products of gradients and positions [m]"""
    other_count: Index = array("n_all_rows")
    """number of nodes of the target that each row meets"""
    other: Index = array("n_others")
    """these nodes, row by row"""
    other_gradient: Array = array("n_others", 3)
    """gradient of the gap by the motion of each, in the axes of the target"""
    listed: Index = array("n_nodes")
    """place of each node among those of one row, -1: it is not there"""
    gradient: Array = array("n_contact_supports", 3)
    """b, the same gradient in body axes"""
    closed: Index = array("n_contact_rows")
    """1: the row is closed; 2: and slips"""
    closed_in_matrix: Index = array("n_contact_rows")
    """1: it was when Newton's matrix was made"""
    count: Index = array("n_islands")
    """number of candidates of each island"""
    candidate: Index = array("n_islands", "n_most_rows")
    """rows of an island that may be closed, among those of all contacts"""
    contact: Index = array("n_islands", "n_most_rows")
    """contact of each candidate"""
    W_count: Index = array("n_islands")
    """number of rows of `W`; 0: it is to be made"""
    W_row: Index = array("n_islands", "n_most_rows")
    """candidates that `W` was made for"""
    W_gradient: Array = array("n_contact_supports", 3)
    """b that `W` was made with"""
    W_other: Index = array("n_others")
    """nodes of targets that it was made with"""
    W_other_gradient: Array = array("n_others", 3)
    """their gradients"""
    W: Array = array("n_islands", "n_most_rows", "n_most_rows", real=True)
    """gaps of the candidates by forces on them [m/N]"""
    factored: Index = array("n_islands", "n_most_rows")
    """1: the candidate is in `factor`"""
    factor: Array = array("n_islands", "n_most_rows", "n_most_rows", real=True)
    """Cholesky's factor of the rows and columns of W that are closed"""
    active: Index = array("n_most_rows")
    """1: the candidate is closed"""
    order: Index = array("n_islands", "n_most_rows")
    """closed candidates, in the order of `factor`"""
    lam: Array = array("n_most_rows")
    """forces of the candidates [N]"""
    y: Array = array("n_most_rows")
    """gaps of the candidates [m]"""
    q: Array = array("n_most_rows")
    """gaps of the candidates without forces [m]"""
    D: Array = array("n_most_rows", "n_most_coordinates", real=True)
    """derivatives of the gaps of closed rows by the coordinates of the bodies of an island"""
    stiffness: Array = array("n_stiffness", real=True)
    """D^T W^-1 D (coordinates, coordinates) of each island, one after the other"""
    is_needed: Index = array("n_nodes")
    """1: the node is around or below a candidate"""
    loaded: Index = array("n_most_displacements")
    """dofs of the nodes of a body that carry loads"""
    column: Array = array("n_most_displacements")
    """displacements of the nodes of a body by one row"""
    push: Array = array("n_bodies", 6)
    """force and moment about the center of mass on each body of surfaces, in body axes [N, N m]"""
    interface_load: Array = array("n_a")
    """T^T f, the loads of contacts as loads on active dofs [N, N m]"""
    slope: Array = array("n_node_slopes")
    """A q (3 n, r) of the nodes of bodies that are awake, one body after the other"""
    change: Array = array("n_a")
    """displacements of the active dofs of a body by all loads of the step [m, rad]"""
    wrench: Array = array(24)
    """generalized forces on the coordinates of a frame"""
