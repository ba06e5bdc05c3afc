"""The statistics of coloured residuals: whitening, surrogates, intervals, spectra over order."""
