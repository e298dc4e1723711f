# SPDX-License-Identifier: Apache-2.0
"""Designs, exports and their verification."""

import filecmp

import pytest
from program import ROOT, answer, assert_prints_as, assert_same, printed, without

import quadtune

FILE = ROOT / "designs" / "mambo-hover.toml"


@pytest.fixture(scope="module")
def design(tmp_path_factory):
    directory = tmp_path_factory.mktemp("design") / "out"
    return quadtune.design(FILE, directory=directory, seeds=2), directory


def test_a_design_is_that_of_the_program(design, tmp_path):
    result, directory = design
    expected = answer("design", FILE, "-o", tmp_path / "out", "--seeds", "2")
    skip = ("wall_s", "directory")
    assert without(result.to_dict(), *skip) == without(expected, *skip)
    assert result.passed and result.failure == ""
    assert_same(result.gains.K, expected["lqr"]["K"])
    assert [flight.passed for flight in result.flights] == [True] * len(result.flights)
    written = sorted(path.name for path in directory.iterdir())
    assert written == sorted(path.name for path in (tmp_path / "out").iterdir())
    for file in result.files:
        assert filecmp.cmp(directory / file.path, tmp_path / "out" / file.path, shallow=False)


def test_what_was_written_verifies(design):
    _, directory = design
    report = quadtune.verify(directory)
    assert report.ok
    assert_prints_as(report, "verify", directory)
    assert [check.ok for check in report.checks] == [True] * len(report.checks)
    assert report.gains.K.shape[0] == 4


def test_a_changed_file_does_not_verify(design, tmp_path):
    _, directory = design
    copy = tmp_path / "copy"
    copy.mkdir()
    for path in directory.iterdir():
        (copy / path.name).write_bytes(path.read_bytes())
    changed = next(path for path in copy.iterdir() if path.name == "controllerVars.m")
    changed.write_text(changed.read_text() + "\n")
    report = quadtune.verify(copy)
    assert not report.ok
    assert any(not check.ok and "controllerVars.m" in check.detail for check in report.checks)
    assert report.to_dict()["verdict"] == "fail"


def test_an_export_is_that_of_the_program(design, tmp_path):
    _, directory = design
    result = quadtune.export(directory, "c", tmp_path / "here", law="cascaded-pid",
                             precision="double")
    assert_prints_as(result, "export", directory, "--to", "c", "-o", tmp_path / "there",
                     "--law", "cascaded-pid", "--precision", "double")
    assert len(result.files) > 3
    for file in result.files:
        assert filecmp.cmp(tmp_path / "here" / file.path, tmp_path / "there" / file.path,
                           shallow=False)


@pytest.mark.parametrize("words, where", [
    ({"to": "cc"}, "to"),
    ({"to": "json", "adapter": "main"}, "adapter"),
    ({"to": "json", "firmware": "1.15"}, "firmware"),
    ({"to": "json", "constants": True}, "constants"),
    ({"to": "c", "law": "fuzzy"}, "law"),
    ({"to": "c", "name": "9"}, "name"),
])
def test_a_wrong_argument_is_named(design, tmp_path, words, where):
    _, directory = design
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.export(directory, directory=tmp_path / "out", **words)
    assert refused.value.where == where
    assert not (tmp_path / "out").exists()


def test_an_export_over_its_source_is_refused(design):
    _, directory = design
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.export(directory, "json", directory)
    assert refused.value.where == "directory"


def test_a_wrong_design_file_is_named(tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text('name = "wrong"\nvehicle = "mambo"\n[lqrr]\n')
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.design(file)
    assert refused.value.where.startswith(f"{file}:")
    with pytest.raises(quadtune.FileError):
        quadtune.design(tmp_path / "absent.toml")


def test_no_directory_to_verify(tmp_path):
    with pytest.raises(quadtune.FileError) as refused:
        quadtune.verify(tmp_path / "absent")
    assert "absent" in refused.value.where


def test_the_text_is_that_of_the_program(design):
    _, directory = design
    assert "verdict: pass" in str(quadtune.verify(directory))
    assert printed("verify", directory)
