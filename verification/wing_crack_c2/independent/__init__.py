"""An independent model of scene C2: displacement discontinuities and fluid sources in a plane."""
