"""Units of columns and fields."""

from __future__ import annotations

from wingcrack.names import columns

FARTHEST = 1.0e8  # of places and lengths [m]: farther than the earth is wide

# Ends of column names and their units; longer ends come first. A test holds them against
# the table of names.
_ENDS = (
    ("_pa_sqrtm", "Pa m^1/2"),
    ("_m2_s_pa", "m2/s/Pa"),
    ("_j_m2", "J/m2"),
    ("_m2_s", "m2/s"),
    ("_nm_s", "N m/s"),
    ("_m_s", "m/s"),
    ("_nm", "N m"),
    ("_m2", "m2"),
    ("_deg", "degree"),
    ("_pa", "Pa"),
    ("_j", "J/m"),
    ("_m", "m"),
    ("_s", "s"),
    ("_k", "K"),
)
# those that their name alone does not tell: per metre of thickness
_OF_COLUMNS = {"seismic_moment_nm": "N m/m", "seismic_moment_error_nm": "N m/m"}

NONE = "-"


def column_unit(column: str) -> str:
    """Unit of a column of a table, ``-`` for numbers, names and words.

    >>> column_unit("k1_dc_pa_sqrtm")
    'Pa m^1/2'
    """
    if column in _OF_COLUMNS:
        return _OF_COLUMNS[column]
    return next((unit for end, unit in _ENDS if column.endswith(end)), NONE)


def column_words(column: str) -> str:
    """Name of a column without its unit, as an axis has it.

    >>> column_words("well_pressure_pa")
    'well pressure'
    """
    end = next((end for end, _ in _ENDS if column.endswith(end)), "")
    return column.removesuffix(end).replace("_", " ")


def field_unit(name: str) -> str:
    """Unit of a field of the VTU files, ``-`` for numbers and states."""
    fields = (rows for file, rows in columns().items() if file.endswith(".vtu"))
    return next((rows[name]["unit"] for rows in fields if name in rows), NONE)
