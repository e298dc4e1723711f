# SPDX-License-Identifier: Apache-2.0
"""Certificates."""

import math

import pytest
from program import ROOT, answer, assert_prints_as

import quadtune

RANGES = {"mass": (0.98, 1.02), "inertia": (1.0, 1.0), "thrust": (0.98, 1.02)}
OPTIONS = ["--mass", "0.98:1.02", "--inertia", "1:1", "--thrust", "0.98:1.02", "--budget", "300"]


@pytest.fixture(scope="module")
def export(tmp_path_factory):
    directory = tmp_path_factory.mktemp("certify") / "out"
    quadtune.export(ROOT / "designs" / "uquad-hover.toml", "uquad", directory)
    return directory


def test_a_certificate_is_that_of_the_program(export):
    report = quadtune.certify(export, budget=300, plant="ideal", **RANGES)
    options = ["certify", export, "--plant", "ideal", *OPTIONS]
    assert_prints_as(report, *options)
    expected = answer(*options)
    assert report.vehicle == "uquad" and report.verdict == expected["verdict"]
    law = report.laws[0]
    assert law.name == "state feedback" and law.dt == 0.01
    assert law.proved == (law.reason == "")
    assert 0 < law.worst_radius < 1 or math.isinf(law.worst_radius)
    assert law.boxes > 0


def test_the_default_box_is_the_spread_of_the_vehicle(tmp_path):
    file = tmp_path / "mine.toml"
    text = (ROOT / "vehicles" / "quad-450.toml").read_text()
    file.write_text(text + "\n[spread]\nmass = 0.02\ninertia = 0.3\nthrust = 0.08\n")
    quadtune.export(file, "json", tmp_path / "out")
    report = quadtune.certify(tmp_path / "out", budget=1, plant="ideal")
    assert_prints_as(report, "certify", tmp_path / "out", "--budget", "1", "--plant", "ideal")
    assert "mass 0.98, inertia x 0.7" in report.laws[0].reason


@pytest.mark.parametrize("words, where", [
    ({"mass": (1.2, 1.3)}, "mass"),
    ({"thrust": (1.1, 0.9)}, "thrust"),
    ({"delay": (-0.1, 0.1)}, "delay"),
    ({"plant": "real"}, "plant"),
    ({"controller": "fuzzy"}, "controller"),
    ({"budget": 0}, "budget"),
])
def test_a_wrong_argument_is_named(export, words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.certify(export, **words)
    assert refused.value.where == where


def test_a_changed_export_is_refused(export, tmp_path):
    copy = tmp_path / "copy"
    copy.mkdir()
    for path in export.iterdir():
        (copy / path.name).write_bytes(path.read_bytes())
    (copy / "K_prop_full.txt").write_text("1\n")
    with pytest.raises(quadtune.InvalidInput, match="does not verify") as refused:
        quadtune.certify(copy)
    assert refused.value.where == str(copy)
