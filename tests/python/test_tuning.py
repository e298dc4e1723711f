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


def test_weights_over_missions_are_those_of_the_program(tmp_path):
    result = quadtune.tune_lqr("mambo", ["hover"], evaluations=4, draws=1, proof=2, duration=14,
                               budget=1000)
    options = ["tune", "lqr", "mambo", "--mission", "hover", "--evaluations", "4", "--monte-carlo",
               "1", "--proof", "2", "--duration", "14", "--budget", "1000"]
    skip = ("seconds", "time_s", "seconds_s")
    assert without(result.to_dict(), *skip) == without(answer(*options), *skip)
    assert len(result.weights.names) == len(result.weights.weights) == 16
    assert np.isfinite(result.start.gains.K).all()
    assert result.evaluations == len(result.costs) and result.reason
    if not result.accepted:
        assert np.array_equal(result.weights.weights, result.start.weights)
    result.save_design(tmp_path / "found.toml")
    design = quadtune.lqr("mambo", plant="ideal", inputs="wrench", method="sampled", dt=0.005,
                          Q=result.start.weights[:12], R=result.start.weights[12:])
    assert np.allclose(design.K, result.start.gains.K, rtol=1e-9, atol=1e-12)


def test_weights_of_a_known_gain_are_those_of_the_program(tmp_path):
    design = ROOT / "designs" / "uquad-hover.toml"
    match = quadtune.tune_lqr("uquad", match_gains=design, R=0.01, starts=2)
    options = ["tune", "lqr", "uquad", "--match-gains", design, "--R", "0.01", "--starts", "2"]
    assert_prints_as(match, *options)
    expected = answer(*options)
    assert match.status == expected["status"] and match.matched == (match.status == "matched")
    assert np.array_equal(match.Q, expected["Q"]) and np.array_equal(match.R, expected["R"])
    assert match.K.shape == match.K_given.shape == (len(match.inputs), len(match.states))
    assert match.difference == (expected["difference"]["before"], expected["difference"]["after"])
    assert [one.name for one in match.weights] == [one["name"] for one in expected["weights"]]
    assert match.weighted_sensitivity == expected["weighted_sensitivity"]["value"]
    match.save_design(tmp_path / "matched.toml")
    text = (tmp_path / "matched.toml").read_text()
    assert "[published]" in text and "tune_lqr" in text


@pytest.mark.parametrize("words, where", [
    ({}, "missions"),
    ({"missions": ["hover"], "inputs": "rotor-speed"}, "inputs"),
    ({"missions": ["hover"], "convention": "uquad"}, "Q"),
    ({"missions": ["hover"], "method": "continuous"}, "method"),
    ({"missions": ["hover"], "budget": 0.0}, "budget"),
    ({"missions": ["hover"], "Q": [1, 2]}, "Q"),
    ({"match_gains": ROOT / "designs" / "uquad-hover.toml", "tolerance": 0.0}, "tolerance"),
    ({"match_gains": ROOT / "designs" / "uquad-hover.toml", "starts": 0}, "starts"),
    ({"match_gains": ROOT / "designs" / "uquad-hover.toml", "tie": ["none,x"]}, "tie"),
    ({"match_gains": ROOT / "designs" / "uquad-hover.toml", "R": 0.0}, "R"),
])
def test_a_wrong_argument_of_tune_lqr_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.tune_lqr("uquad", **words)
    assert refused.value.where == where
