"""The documentation as a site: its pages, those of the Fortran modules, the gallery."""
