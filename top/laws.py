"""Force laws of springs: `du.springs.point(a, b, law=du.laws.OneSidedLaw(...))`."""

from duhamel.solver.laws.bouc_wen import BoucWenLaw
from duhamel.solver.laws.check import check_law
from duhamel.solver.laws.dampers import DamperLaw, TabulatedDamperLaw
from duhamel.solver.laws.elastoplastic import ElastoplasticLaw
from duhamel.solver.laws.iwan import IwanLaw
from duhamel.solver.laws.law import ForceLaw
from duhamel.solver.laws.maxwell import MaxwellLaw
from duhamel.solver.laws.one_sided import OneSidedLaw
from duhamel.solver.laws.tabulated import TabulatedLaw
from duhamel.solver.laws.user import UserLaw

__all__ = [
    "BoucWenLaw",
    "DamperLaw",
    "ElastoplasticLaw",
    "ForceLaw",
    "IwanLaw",
    "MaxwellLaw",
    "OneSidedLaw",
    "TabulatedDamperLaw",
    "TabulatedLaw",
    "UserLaw",
    "check_law",
]
