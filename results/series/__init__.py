"""What shock engineers make of a time series: spectra, filters, bands, peaks.

Functions of a time (n,) [s] and samples (n,) or (n, k), one series a column. They are for any
series, also measured ones; transforms.py has them by words, for quantities of results. Source:
docs/spectra.md.
"""

from .bands import Bands, octave_bands
from .filters import butterworth, cfc
from .fourier import Spectrum, cumulative_rms, fourier, psd, rms
from .sampling import Sampled, sampled
from .shock import ShockSpectrum, octave_frequencies, shock_spectrum

__all__ = [
    "Bands",
    "Sampled",
    "ShockSpectrum",
    "Spectrum",
    "butterworth",
    "cfc",
    "cumulative_rms",
    "fourier",
    "octave_bands",
    "octave_frequencies",
    "psd",
    "rms",
    "sampled",
    "shock_spectrum",
]
