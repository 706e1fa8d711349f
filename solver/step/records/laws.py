"""Records of force laws and motors (step/force_laws.py, step/motors.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Motors(Struct):
    """Motors; each is the law of a row of its own."""

    row: Index = array("n_motors")
    """row of each motor"""
    stiffness: Array = array("n_motors")
    """gain of the error [N/m, N m/rad]"""
    damping: Array = array("n_motors")
    """gain of the rate of the error [N s/m, N m s/rad]"""
    integral: Array = array("n_motors")
    """gain of the integral of the error [N/(m s), N m/(rad s)]"""
    lower: Array = array("n_motors")
    """least force or torque [N, N m]"""
    upper: Array = array("n_motors")
    """largest force or torque [N, N m]"""
    speed: Array = array("n_motors")
    """speed without load, at which the limits are zero; infinite: they are constant [m/s, rad/s]"""
    tracking: Array = array("n_motors")
    """rate at which the integral follows a limit, 0: no integral or no limit [1/s]"""


class SpinTables(Struct):
    """What the spin of a shaft adds to the laws of rows of bearings (step/spin_tables.py)."""

    of: Index = array("n_i")
    """table of each row, -1: none"""
    spin: Index = array("n_tables")
    """row whose rate is the spin; two rows of the same coupling before it have the coefficients"""
    first: Index = array("n_tables_1")
    """first speed of each table"""
    speed: Array = array("n_speeds")
    """increasing within a table [rad/s]"""
    stiffness: Array = array("n_speeds", 2)
    """added to the stiffness against the two rows [N/m]"""
    damping: Array = array("n_speeds", 2)
    """added to the damping against the two rows [N s/m]"""


class Laws(Struct):
    """Force laws of compliant rows: a linear one of all rows of a coupling, and some of each row.

    The law of a row may be a motor instead. The force of row i, j over the rows of the same
    coupling, m over its own laws:

        lambda_i = -sum_j (stiffness_ij (c_j - rest_j) + damping_ij dc_j/dt)
                   - sum_m law_m(c_i - rest_i, dc_i/dt)
    """

    rest: Array = array("n_i")
    """coordinate without force [m, rad]"""
    stiffness: Array = array("n_i", 6)
    """stiffness of each row against the rows of its coupling [N/m, N m/rad]"""
    damping: Array = array("n_i", 6)
    """damping of each row against the rows of its coupling [N s/m, N m s/rad]"""
    range: Index = array("n_i_1")
    """first law of each row alone"""
    number: Index = array("n_law")
    """number of the kind of each law (solver/laws)"""
    first: Index = array("n_law_1")
    """first of the parameters of each law"""
    parameters: Array = array("n")
    """parameters of all laws, one law after the other"""
    memory: Index = array("n_law_1")
    """first of the numbers that each law remembers"""
    motor: Index = array("n_i")
    """motor of each row, -1: none"""
    motors: Motors
    tables: SpinTables


class MotorState(Struct):
    """Motors at the last step."""

    integral: Array = array("n_motors")
    """part of the force or torque by the integral of the error [N, N m]"""
    slope: Array = array("n_motors")
    """time derivative of `integral` [N/s, N m/s]"""
    work: Array = array("n_motors")
    """work on the bodies since the start [J]"""
    pole: Array = array("n_motors")
    """largest magnitude of a pole of the control loop at the start, all bodies rigid [rad/s]"""


class MotorWork(Struct):
    """Signals and forces of motors."""

    value: Array = array("n_motor_signals")
    """three signals of each motor: force or torque without an error, reference, rate of that"""
    error: Array = array("n_motors")
    """reference less coordinate [m, rad]"""
    torque: Array = array("n_motors")
    """force or torque within the limits [N, N m]"""
    integral: Array = array("n_motors")
    """part of the force or torque by the integral of the error at the end of the step [N, N m]"""
    slope: Array = array("n_motors")
    """time derivative of `integral` at the end of the step [N/s, N m/s]"""
    scale: Array = array("n_motors")
    """sum of the magnitudes of the parts of the demanded force or torque [N, N m]"""
    status: Index = array("n_motors")
    """-1: at the lower limit, 1: at the upper limit, 0: between them"""
    matrix_status: Index = array("n_motors")
    """status when the matrix was made"""
