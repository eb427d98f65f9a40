"""The pages that list names are those that the table of names gives."""

from __future__ import annotations

from wingcrack.runs.parameter_table import parameters
from wingcrack_docs.tables import pages


def test_the_pages_are_up_to_date() -> None:
    for page, text in pages().items():
        assert page.read_text(encoding="utf-8") == text, f"{page}: ./wingcrack docs writes it again"


def test_every_name_is_on_its_page() -> None:
    texts = {page.name: text for page, text in pages().items()}
    assert sorted(texts) == ["input.md", "limits.md", "output.md"]
    assert not any("{{" in text for text in texts.values())
    rows = [line for line in texts["input.md"].splitlines() if line.count(" | ") == 5]
    expert = texts["input.md"].partition("\n## For experts")[2].partition("\n## ")[0]
    rare = [line for line in expert.splitlines() if line.startswith("| `&")]
    assert len(rare) == 6  # with their group in front
    heads = texts["input.md"].count("\n## &")
    assert len(rows) + len(rare) == len(parameters()) + heads
