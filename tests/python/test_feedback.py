# SPDX-License-Identifier: Apache-2.0
"""State feedback of vehicles: lqr and lqg."""

import pytest
from program import answer, assert_prints_as, assert_same

import quadtune


def test_lqr_on_the_flown_plant_is_that_of_the_program():
    law = quadtune.lqr("crazyflie")
    assert isinstance(law, quadtune.FlownLqr)
    assert_prints_as(law, "lqr", "crazyflie")
    expected = answer("lqr", "crazyflie")
    assert_same(law.K, expected["K"])
    assert_same(law.K_int, expected["K_int"])
    assert law.gains.states == [state["name"] for state in expected["states"]]
    assert law.gains.dt == expected["dt_s"]
    assert law.flown.stable and law.flown.largest_pole == expected["flown"]["largest_pole"]
    assert law.riccati.solved


def test_weights_and_the_rest_are_those_of_the_program():
    Q = [10.0, 10, 20, 5, 5, 5, 1, 1, 1, 0.1, 0.1, 0.1, 2, 2]
    law = quadtune.lqr("mambo", Q=Q, R=0.5, integral=["px", "py"], dt=0.004, past=1, height=2.0)
    assert_prints_as(law, "lqr", "mambo", "--Q", ",".join(map(repr, Q)), "--R", "0.5",
                     "--integral", "px,py", "--dt", "0.004", "--past", "1", "--height", "2.0")


def test_lqr_of_a_matrix_is_that_of_the_program():
    law = quadtune.lqr("mambo", structure="matrix", convention="mambo")
    assert isinstance(law, quadtune.MatrixLqr)
    options = ["lqr", "mambo", "--structure", "matrix", "--convention", "mambo"]
    assert_prints_as(law, *options)
    assert_same(law.K, answer(*options)["K"])


def test_lqr_on_the_ideal_plant_is_that_of_the_program():
    Q = [1, 1, 1, 1e3, 1e3, 1e3, 1, 1, 1, 1, 1, 1]
    law = quadtune.lqr("uquad", convention="uquad", Q=Q, R=0.01, method="discrete", dt=0.01)
    assert isinstance(law, quadtune.IdealLqr)
    options = ["lqr", "uquad", "--convention", "uquad", "--Q", ",".join(map(repr, Q)), "--R",
               "0.01", "--method", "discrete", "--dt", "0.01"]
    assert_prints_as(law, *options)
    expected = answer(*options)
    assert_same(law.K, expected["K"])
    assert_same(law.riccati.X, expected["S"])
    assert law.margins.loops[0].Ms == expected["margins"]["loops"][0]["Ms"]
    assert_same(law.model.A, answer("linearize", "uquad", "--convention", "uquad")["A"])


def test_an_ideal_problem_without_solution_is_a_result():
    law = quadtune.lqr("mambo", plant="ideal", Q=[0] + [1.0] * 11)
    assert not law.solved
    assert "px" in law.riccati.culprit
    with pytest.raises(quadtune.NoSolution):
        law.to_dict()


@pytest.mark.parametrize("words, where", [
    ({"Q": [1, 2, 3]}, "Q"),
    ({"R": 0.0}, "R"),
    ({"R": [-1.0, 1, 1, 1]}, "R"),
    ({"past": 1000}, "past"),
    ({"change": 1, "past": 0}, "change"),
    ({"dt": -1.0}, "dt"),
    ({"height": 0.0}, "height"),
    ({"plant": "real"}, "plant"),
    ({"plant": "flown", "at": "line"}, "at"),
    ({"at": "hover", "past": 1}, "plant"),
    ({"structure": "sparse"}, "structure"),
    ({"structure": "matrix", "past": 1}, "structure"),
    ({"estimator": "none"}, "estimator"),
    ({"method": "sampled"}, "dt"),
    ({"method": "exact", "dt": 0.01}, "method"),
    ({"evidence": "some"}, "evidence"),
])
def test_a_wrong_argument_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.lqr("mambo", **words)
    assert refused.value.where == where


def test_lqg_is_that_of_the_program():
    lqg = quadtune.lqg("crazyflie", time=20.0)
    assert_prints_as(lqg, "lqg", "crazyflie", "--time", "20")
    expected = answer("lqg", "crazyflie", "--time", "20")
    assert_same(lqg.K, expected["K"])
    assert lqg.rms.time == 20
    assert list(lqg.rms.state) == list(expected["predicted_rms"]["state"].values())
    assert lqg.recovery == 1


def test_lqg_names_a_wrong_argument():
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.lqg("mambo", noise_budget=2.0)
    assert refused.value.where == "noise_budget"
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.lqg("mambo", time=0.0)
    assert refused.value.where == "time"
