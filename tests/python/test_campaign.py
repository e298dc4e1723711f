# SPDX-License-Identifier: Apache-2.0
"""Campaigns."""

import filecmp

import numpy as np
import pytest
from program import answer, without

import quadtune

TEXT = """
name = "small"
vehicle = "mambo"
flights = 6
seed = 5
[[design]]
name = "designed"
gains = "designed"
[[design]]
name = "published"
gains = "published"
[[mission]]
mission = "hover"
duration_s = 3
[[vary]]
quantity = "mass"
uniform = { low = 0.9, high = 1.1 }
[keep]
failures = 0
sample = 1
"""


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    file = folder / "small.toml"
    file.write_text(TEXT)
    return quadtune.campaign(file, folder / "here", threads=2), file


def test_a_campaign_is_that_of_the_program(campaign):
    result, file = campaign
    there = file.parent / "there"
    expected = answer("campaign", "run", file, there)
    said = result.to_dict()
    assert without(said, "files", "replay") == without(
        answer("campaign", "merge", result.folder), "files", "replay")
    assert said["cases"][0]["success"] == expected["cases"][0]["success"]
    for name in ("flights.csv", "campaign.sqlite"):
        assert filecmp.cmp(f"{result.folder}/{name}", there / name, shallow=False)


def test_records_are_arrays(campaign):
    result, _ = campaign
    assert len(result) == 12 and result.designs == ["designed", "published"]
    assert result.missions == ["hover", "hover"]
    assert result.passed.shape == (12,) and result.passed.dtype == bool
    energy = result["energy"]
    assert energy.shape == (12,) and np.isfinite(energy).all()
    assert result.quantities == ["mass"]
    assert result.drawn.size == 6
    assert (result.drawn >= 0.9).all() and (result.drawn <= 1.1).all()
    with pytest.raises(KeyError, match="energi"):
        result["energi"]
    assert "energy" in result.metrics


def test_a_flight_is_replayed(campaign):
    result, _ = campaign
    flight = result.replay(3)
    expected = answer("campaign", "replay", result.folder, "--flight", "3")
    assert without(flight.to_dict(), "wall_s") == without(expected, "wall_s")
    assert flight.metrics["energy"] == result["energy"][3]
    assert "t" in flight
    with pytest.raises(quadtune.InvalidInput) as refused:
        result.replay(12)
    assert refused.value.where == "number"


def test_a_campaign_is_loaded_again(campaign):
    result, _ = campaign
    again = quadtune.load_campaign(result.folder)
    assert np.array_equal(again["energy"], result["energy"])
    assert again.to_json() == result.to_json()


def test_a_wrong_file_is_named(tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text(TEXT.replace("mass", "mas"))
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.campaign(file, tmp_path / "out")
    assert refused.value.where.startswith(f"{file}:")
