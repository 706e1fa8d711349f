"""The fields of bodies that pictures, films and reports show."""

FIELDS = {
    "displacement": ("elastic displacement", "m"),
    "velocity": ("velocity", "m/s"),
    "von_mises": ("von Mises stress", "Pa"),
}
"""their names and units"""
WORST = "worst"
"""the time at which a field is largest"""
