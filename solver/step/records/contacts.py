"""Records of contacts and friction (step/contacts.py, step/events.py, step/friction.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Friction(Struct):
    """Coulomb friction on the last rows of couplings, by the normal force of rows before them.

    The normal force is preload + the sum over groups of rows of sqrt(sum (weight lambda)^2). The
    coefficient falls from `static` to `sliding` with the square of the slip rate over `speed`.
    """

    first: Index = array("n_r")
    """first row with friction"""
    n: Index = array("n_r")
    """number of rows with friction: 1 or 2"""
    static: Array = array("n_r")
    """coefficient of friction at rest"""
    sliding: Array = array("n_r")
    """coefficient of friction at high slip rates"""
    speed: Array = array("n_r")
    """slip rate at which the coefficient has fallen by 1 - 1/e of the way [m/s, rad/s]"""
    stiffness: Array = array("n_r")
    """stiffness of the bristle [N/m, N m/rad]"""
    damping: Array = array("n_r")
    """damping of the bristle [N s/m, N m s/rad]"""
    viscous: Array = array("n_r")
    """viscous friction per slip rate [N s/m, N m s/rad]"""
    preload: Array = array("n_r")
    """normal force that acts always [N]"""
    weight: Array = array("n_i")
    """factor of each multiplier in the normal force; 0: it has no part in it"""
    group: Index = array("n_i")
    """group of each row in the normal force"""


class ContactState(Struct):
    """Contacts since they closed, and events: contacts that ended.

    Couplings that are contacts come first, then contacts of surfaces.
    """

    steps: Index = array("n_touching")
    """steps since the contact closed, 0: open"""
    begin: Array = array("n_touching")
    """time when the contact closed [s]"""
    whole: Index = array("n_touching")
    """1: the contact was open before, so that its event has a beginning"""
    closing_speed: Array = array("n_touching")
    """rate of approach when the contact closed [m/s, rad/s]"""
    peak: Array = array("n_touching")
    """largest normal force since the contact closed [N, N m]"""
    impulse: Array = array("n_touching")
    """impulse of the normal force since the contact closed [N s, N m s]"""
    total_impulse: Array = array("n_touching")
    """impulse of the normal force since t = 0 [N s, N m s]"""
    work: Array = array("n_touching")
    """work on the bodies until the contact closed [J]"""
    work_done: Array = array("n_touching")
    """work on the bodies until now [J]"""
    ended: Index = array("n_touching")
    """number of events since the start of the run"""
    n_events: Index = array(1)
    """number of events in `event` that are not handed over yet"""
    event_contact: Index = array("n_v")
    """contact of each event"""
    place: Array = array("n_k", 3)
    """center of the ball at the last step, in the axes of frame A [m]"""
    passed: Index = array(1)
    """1 + the first contact whose ball passed unnoticed in the last step, 0: none (passages.py);
    contacts of surfaces follow those of couplings"""
    event: Array = array("n_v", 9)
    """start, end, steps, peak, impulse, closing and opening speed, restitution, dissipated"""
