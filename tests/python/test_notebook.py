# SPDX-License-Identifier: Apache-2.0
"""docs/notebook.md: its cells run as they are written."""

import re

from program import ROOT

PAGE = ROOT / "docs" / "notebook.md"


def cells():
    return re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), flags=re.MULTILINE | re.DOTALL)


def test_from_a_vehicle_to_a_plotted_flight_in_fifteen_lines(tmp_path, monkeypatch):
    import matplotlib
    matplotlib.use("agg")
    monkeypatch.chdir(tmp_path)
    first = cells()[0]
    assert len([line for line in first.split("\n") if line.strip()]) <= 15
    names = {}
    exec(compile(first, str(PAGE), "exec"), names)
    pictures = list(tmp_path.glob("*.png"))
    assert len(pictures) == 1
    assert pictures[0].read_bytes().startswith(b"\x89PNG")
    figure = names["plt"].gcf()
    lines = [line for axes in figure.axes for line in axes.get_lines()]
    assert len(lines) >= 2
    assert all(len(line.get_xdata()) > 100 for line in lines[:2])


def test_the_other_cells_run_after_it(tmp_path, monkeypatch):
    import matplotlib
    matplotlib.use("agg")
    monkeypatch.chdir(tmp_path)
    names = {}
    assert len(cells()) >= 3
    for cell in cells():
        exec(compile(cell, str(PAGE), "exec"), names)
