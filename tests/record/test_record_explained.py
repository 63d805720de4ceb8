"""The record that the documents explain line by line is what the mission there comes to."""

from __future__ import annotations

import json
import re
from pathlib import Path

import teamformer as tf
from hand_logs import RECORD
from teamformer.record.files.writing import save_record

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "record.md"


def test_each_line_that_is_explained_stands_in_the_record(tmp_path: Path) -> None:
    text = PAGE.read_text(encoding="utf-8")
    part = text[text.index("## A record, line by line") : text.index("## Plans in a record")]
    (tmp_path / "beam.yaml").write_text(re.findall(r"```yaml[^\n]*\n(.*?)```", part, re.DOTALL)[0])
    tf.run(tf.load(tmp_path / "beam.yaml")).save(tmp_path)
    record = (tmp_path / "record.json").read_text(encoding="utf-8")
    lines = re.findall(r"^\| `(.*?)` \|", part, re.MULTILINE)
    assert len(lines) == 14
    for line in lines:
        assert line.removesuffix("...") in record, line
    assert json.loads(record)["end"]["makespan"] == 5


def test_each_line_of_continuous_time_stands_in_the_record(tmp_path: Path) -> None:
    text = PAGE.with_name("record-in-time.md").read_text(encoding="utf-8")
    part = text[: text.index("The kinds of events")]
    save_record(RECORD, tmp_path / "record.json")
    record = (tmp_path / "record.json").read_text(encoding="utf-8")
    lines = re.findall(r"^\| `(.*?)` \|", part, re.MULTILINE)
    assert len(lines) == 10
    for line in lines:
        assert line.removesuffix("...") in record, line
