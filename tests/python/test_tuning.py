# SPDX-License-Identifier: Apache-2.0
"""Noise covariances from logs, and gains over missions."""

import numpy as np
import pytest
from program import ROOT, answer, assert_prints_as, without

import quadtune

LOG = ROOT / "docs" / "examples" / "bobbing.csv"


@pytest.fixture(scope="module")
def tuned():
    return quadtune.tune_kalman("altitude", [LOG])


def test_covariances_are_those_of_the_program(tuned):
    options = ["tune", "kalman", "--model", "altitude", "--log", LOG]
    assert_prints_as(tuned, *options)
    expected = answer(*options)
    assert tuned.status == expected["status"]
    assert tuned.passed == (expected["gate"]["verdict"] == "pass")
    before, after = tuned.log_likelihood
    assert after == expected["log_likelihood"]["after"] > before
    assert tuned.parameters and all(np.isfinite(one.value) for one in tuned.parameters)


def test_the_tuned_model_is_a_filter_model(tuned, tmp_path):
    file = tmp_path / "tuned.toml"
    tuned.save_model(file)
    again = quadtune.tune_kalman(file, [LOG], fix=[one.name for one in tuned.parameters])
    assert again.log_likelihood[0] == pytest.approx(tuned.log_likelihood[1], rel=1e-9)


@pytest.mark.parametrize("words, where", [
    ({"method": "mle"}, "method"),
    ({"holdout": 1.0}, "holdout"),
    ({"starts": 0}, "starts"),
    ({"budget": 0.0}, "budget"),
    ({"rate": -1.0}, "rate"),
    ({"columns": "t_s:"}, "columns"),
])
def test_a_wrong_argument_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.tune_kalman("altitude", [LOG], **words)
    assert refused.value.where == where


def test_gains_over_missions_are_those_of_the_program(tmp_path):
    result = quadtune.tune_pid("mambo", ["hover"], evaluations=4, draws=1, proof=2, duration=14,
                               budget=1000)
    options = ["tune", "pid", "mambo", "--mission", "hover", "--evaluations", "4", "--monte-carlo",
               "1", "--proof", "2", "--duration", "14", "--budget", "1000"]
    skip = ("seconds", "time_s", "seconds_s")
    assert without(result.to_dict(), *skip) == without(answer(*options), *skip)
    assert len(result.loops) == len(result.start) == len(result.candidate) == 6
    assert result.evaluations == len(result.costs)
    assert result.reason
    if not result.accepted:
        assert [loop.Kp for loop in result.loops] == [loop.Kp for loop in result.start]
    result.save_design(tmp_path / "found.toml")
    assert "mambo" in (tmp_path / "found.toml").read_text()


@pytest.mark.parametrize("words, where", [
    ({}, "missions"),
    ({"missions": ["hover"], "budget": -1.0}, "budget"),
    ({"missions": ["hover"], "sensors": "perfect"}, "sensors"),
    ({"missions": ["hover"], "measure": "median"}, "measure"),
    ({"requirements": ROOT / "campaigns" / "mambo-requirements.toml", "wind": "light"}, "wind"),
])
def test_a_wrong_argument_of_a_search_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.tune_pid("mambo", **words)
    assert refused.value.where == where
