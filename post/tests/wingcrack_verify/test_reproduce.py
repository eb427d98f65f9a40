"""`wingcrack reproduce`: the files of the papers, and a quick run with its table."""

from __future__ import annotations

import csv
from pathlib import Path
from types import SimpleNamespace

import pytest

from wingcrack.errors import CaseError
from wingcrack_verify.paper import read_paper
from wingcrack_verify.reproduce import reproduce

TOP = Path(__file__).parents[3]
PAPERS = sorted((TOP / "inputs" / "papers").glob("*.toml"))


@pytest.mark.parametrize("file", PAPERS, ids=lambda file: file.stem)
def test_papers_name_cases_runs_and_studies_that_are_there(file: Path) -> None:
    paper = read_paper(file, TOP / "verification", quick=False)
    assert paper.numbers
    assert all(study.is_file() for study in paper.studies)
    assert all(number.run is None or number.run in paper.runs for number in paper.numbers)


def test_tables_of_the_thesis_are_whole() -> None:
    numbers = read_paper(PAPERS[1], TOP / "verification", quick=False).numbers
    table_2 = [number for number in numbers if number.place.startswith("table 2")]
    assert sum(number.measured is not None for number in table_2) == 14
    for table in ("B1", "B2"):
        found = [number for number in numbers if number.place.startswith(f"table {table}")]
        assert len(found) == 35
        assert all(number.thesis and number.exact for number in found)


def test_a_quick_call_writes_table_and_page(tmp_path: Path) -> None:
    given = SimpleNamespace(
        paper="paper_b",
        papers=TOP / "inputs" / "papers",
        cases=TOP / "verification",
        build=TOP / "build" / "release",
        cache=tmp_path / "cache",
        out=tmp_path / "out",
        jobs=2,
        quick=True,
    )
    assert reproduce(given) == 0
    with (given.out / "table.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 14
    for row in rows:  # the budget of verification/cracked_disc: 0.2 % of the largest of a column
        largest = 3.0074 if "K_I " in row["quantity"] else 2.0136
        assert abs(float(row["ours"]) - float(row["exact"])) <= 0.002 * largest
        assert abs(float(row["ours"]) - float(row["exact"])) <= float(row["ours_error"])
    page = (given.out / "index.html").read_text(encoding="utf-8")
    assert "1.0269" in page
    assert all((given.out / "figures" / f"figure_0{n}.svg").is_file() for n in (1, 2))


def test_wrong_files_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "paper.toml"
    for text, said in (
        ('[[number]]\nplace = "1"\nquantity = "K"\nunit = "-"\nrun = "a: b"\n', "go together"),
        ('[[figure]]\nplace = "1"\nrun = "a: b"\n', "'of' or 'case'"),
        ('[[figure]]\nplace = "1"\ncase = "a: b"\n', "there is no case 'a'"),
        ('[[figure]]\nplace = "1"\ncase = "kgd: b"\n', "has no figure or check 'b'"),
        ('[[figure]]\nplace = "1"\nrun = "kgd: b"\nof = ["story"]\n', "there is no run 'kgd: b'"),
    ):
        file.write_text(f'title = "t"\n{text}', encoding="utf-8")
        with pytest.raises(CaseError, match=said):
            read_paper(file, TOP / "verification", quick=False)
