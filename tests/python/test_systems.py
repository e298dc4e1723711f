# SPDX-License-Identifier: Apache-2.0
"""Pole placement and properties of linear systems."""

import numpy as np
import pytest
from program import answer, assert_prints_as, assert_same, assert_same_poles

import quadtune

A, B = [[0, 1], [2, -0.5]], [[0], [1]]
MATRICES = ["--A", "0 1; 2 -0.5", "--B", "0; 1"]


@pytest.mark.parametrize("poles, option, words, options", [
    ([-2, -5], "-2,-5", {}, []),
    ([-1 + 2j, -1 - 2j], "-1+2i,-1-2i", {}, []),
    (np.array([0.9, 0.8]), "0.9,0.8", {"dt": 0.01}, ["--dt", "0.01"]),
])
def test_place_is_that_of_the_program(poles, option, words, options):
    result = quadtune.place(A, B, poles, **words)
    assert result.solved and result.status == "solved" and not result.culprit
    given = ["place", *MATRICES, "--poles", option, *options]
    assert_prints_as(result, *given)
    expected = answer(*given)
    assert_same(result.K, expected["K"])
    assert_same_poles(result.poles, expected["poles"])
    assert result.error == expected["error"]
    computed = np.linalg.eigvals(np.array(A) - np.array(B) @ result.K)
    assert np.allclose(np.sort_complex(computed), np.sort_complex(np.asarray(poles)), atol=1e-9)


def test_a_mode_that_cannot_be_moved_is_a_result():
    result = quadtune.place(np.diag([2.0, -1.0]), [[0], [1]], [-3, -4])
    assert result.status == "not controllable" and not result.solved
    assert "2" in result.culprit
    assert np.isnan(result.K).all()
    with pytest.raises(quadtune.NoSolution, match="not controllable"):
        result.to_json()


@pytest.mark.parametrize("words", [
    {"poles": [-1 + 1j, -2]}, {"poles": [-1]}, {"poles": [np.nan, -1]}, {"dt": 0.0}])
def test_place_refuses_a_wrong_argument(words):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.place(A, B, **{"poles": [-1, -2], **words})
    assert refused.value.where


@pytest.mark.parametrize("words, options", [
    ({}, []), ({"C": [[1, 0]], "D": [[0.5]]}, ["--C", "1 0", "--D", "0.5"]),
    ({"dt": 0.1}, ["--dt", "0.1"])])
def test_analyze_of_matrices_is_that_of_the_program(words, options):
    system = quadtune.analyze([[0, 1], [-0.5, -0.5]], B, **words)
    assert_prints_as(system, "analyze", "--A", "0 1; -0.5 -0.5", "--B", "0; 1", *options)
    expected = answer("analyze", "--A", "0 1; -0.5 -0.5", "--B", "0; 1", *options)
    assert_same_poles(system.poles, expected["poles"])
    assert system.stable == expected["stable"] and system.rank == expected["rank"]
    assert system.hinf_norm == expected["hinf_norm"]
    assert system.dt == words.get("dt", 0)


def test_analyze_of_a_transfer_function_is_that_of_the_program():
    given = ["analyze", "--num", "1,2", "--den", "1,0.4,4"]
    system = quadtune.analyze(num=[1, 2], den=[1, 0.4, 4])
    assert_prints_as(system, *given)
    expected = answer(*given)
    assert_same_poles(system.zeros, expected["zeros"])
    assert_same(system.dc_gain, expected["dc_gain"])
    assert system.h2_norm == expected["h2_norm"]
    assert system.hinf_frequency == expected["hinf_frequency"]
    w = np.linspace(1.9, 2.1, 2001)
    response = abs(np.polyval([1, 2], 1j * w) / np.polyval([1, 0.4, 4], 1j * w))
    assert system.hinf_norm == pytest.approx(response.max(), rel=1e-5)
    assert_prints_as(quadtune.analyze(num=1, den=[1, -0.5], dt=1), "analyze", "--num", "1",
                     "--den", "1,-0.5", "--dt", "1")


def test_norms_of_an_unstable_system_are_not_defined():
    system = quadtune.analyze(num=1, den=[1, 0])
    assert not system.stable and system.hinf_norm is None and system.dc_gain is None
    assert np.isinf(system.peak_gain) and np.isinf(system.h2_norm)


@pytest.mark.parametrize("call, where", [
    (lambda: quadtune.analyze(num=[1, 0, 0], den=[1, 1]), "num, den"),
    (lambda: quadtune.analyze(num=1, den=[1, 1], dt=-1), "dt"),
    (lambda: quadtune.analyze(A, [[1]]), "A, B, C, D"),
])
def test_analyze_names_a_wrong_argument(call, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        call()
    assert where in refused.value.where
