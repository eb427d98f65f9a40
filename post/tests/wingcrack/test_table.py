"""CSV files: values, and what is said about damaged ones."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from wingcrack.errors import RunError
from wingcrack.figures.table import read_table
from wingcrack.runs.results import column


def _file(folder: Path, text: str) -> Path:
    path = folder / "some.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_columns_by_name(tmp_path: Path) -> None:
    table = read_table(_file(tmp_path, "time_s,state,p_pa\n0.5,stick,-1e-300\n2,open,nan\n"))
    assert table.rows == 2
    assert table.number("time_s").tolist() == [0.5, 2.0]
    assert table.text("state").tolist() == ["stick", "open"]
    assert table.number("p_pa")[0] == -1e-300
    assert np.isnan(table.number("p_pa")[1])


def test_empty_cell_is_nan(tmp_path: Path) -> None:
    values = read_table(_file(tmp_path, "a_m,b_m\n,1\n2,\n")).number("a_m")
    assert np.isnan(values[0])
    assert values[1] == 2.0


def test_quoted_text_holds_commas_and_quotes(tmp_path: Path) -> None:
    table = read_table(_file(tmp_path, 'time_s,detail\n1,"tip 1, ""left"""\n'))
    assert table.text("detail").tolist() == ['tip 1, "left"']


def test_header_alone_is_a_table_without_rows(tmp_path: Path) -> None:
    table = read_table(_file(tmp_path, "a_m,b_m\n"))
    assert table.rows == 0
    assert table.number("b_m").size == 0


def test_line_being_written_is_left_out(tmp_path: Path) -> None:
    assert read_table(_file(tmp_path, "a_m,b_m\n1,2\n3")).number("a_m").tolist() == [1.0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "some.csv: the file is empty, a header line was expected."),
        ("\n1,2\n", "some.csv: the file is empty, a header line was expected."),
        ("a_m,a_m\n1,2\n", "some.csv: a column name stands twice in the header."),
        ("a_m,b_m\n1,2\n3\n4,5\n", "some.csv, line 3: 1 values where the header has 2."),
        ("a_m,b_m\n1,2,3\n", "some.csv, line 2: 3 values where the header has 2."),
    ],
)
def test_damaged_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(RunError, match=re.escape(message) + "$"):
        read_table(_file(tmp_path, text))


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"none\.csv: the file is missing\.$"):
        read_table(tmp_path / "none.csv")


def test_binary_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "some.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(RunError, match=r"some\.csv: the file cannot be read"):
        read_table(path)


def test_missing_column_is_named_with_those_there(tmp_path: Path) -> None:
    table = read_table(_file(tmp_path, "a_m,b_m\n1,2\n"))
    with pytest.raises(
        RunError, match=r"some\.csv: the column 'c_m' is missing \(there are: a_m, b_m\)\.$"
    ):
        table.number("c_m")


def test_text_where_a_number_belongs_is_located(tmp_path: Path) -> None:
    table = read_table(_file(tmp_path, "a_m\n1\n****\n"))
    with pytest.raises(
        RunError, match=r"some\.csv, line 3: '\*\*\*\*' in column 'a_m' is no number\.$"
    ):
        table.number("a_m")


def test_columns_are_read_once_and_not_changed(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text("time_s,kind\n0.0,a\n1.5,b\n", encoding="utf-8")
    table = read_table(path)
    numbers = table.number("time_s")
    assert table.number("time_s") is numbers
    with pytest.raises(ValueError, match="read-only"):
        numbers[0] = 1.0
    mine = column(table, "time_s")
    mine[0] = 7.0
    assert table.number("time_s").tolist() == [0.0, 1.5]
    column(table, "kind")[0] = "c"
    assert table.text("kind").tolist() == ["a", "b"]
