# SPDX-License-Identifier: Apache-2.0
"""PID gains of transfer functions and of vehicles."""

import pytest
from program import answer, assert_prints_as, assert_same

import quadtune

PLANT = ["pid", "--num", "1", "--den", "1,3,3,1"]


@pytest.mark.parametrize("words, options", [
    ({"type": "PI", "crossover": 0.5205, "phase_margin": 60},
     ["--type", "PI", "--crossover", "0.5205", "--phase-margin", "60"]),
    ({"rule": "simc", "type": "PI", "tau_c": 0.5},
     ["--rule", "simc", "--type", "PI", "--tau-c", "0.5"]),
    ({"Ms_max": 1.6, "type": "PI", "Mt_max": 1.3},
     ["--Ms-max", "1.6", "--type", "PI", "--Mt-max", "1.3"]),
])
def test_gains_of_a_transfer_function_are_those_of_the_program(words, options):
    result = quadtune.pid(num=1, den=[1, 3, 3, 1], **words)
    assert_prints_as(result, *PLANT, *options)
    expected = answer(*PLANT, *options)
    assert (result.Kp, result.Ki, result.Kd, result.Tf) == tuple(
        expected[name] for name in ("Kp", "Ki", "Kd", "Tf"))
    assert result.margins.loops[0].Ms == expected["Ms"]


@pytest.mark.parametrize("words, options", [
    ({"dt": 0.01}, ["--dt", "0.01"]),
    ({"dt": 0.01, "integrator": "euler"}, ["--dt", "0.01", "--integrator", "euler"])])
def test_the_discrete_controller_is_that_of_the_program(words, options):
    result = quadtune.pid(num=1, den=[1, 3, 3, 1], rule="simc", type="PI", **words)
    given = [*PLANT, "--rule", "simc", "--type", "PI", *options]
    assert_prints_as(result, *given)
    expected = answer(*given)["discrete"]
    assert_same(result.num, expected["num"])
    assert_same(result.den, expected["den"])
    assert result.dt == 0.01 and "u[k] = " in str(result)


@pytest.mark.parametrize("words, options", [
    ({}, []), ({"rule": "tyreus-luyben", "type": "PI"},
               ["--rule", "tyreus-luyben", "--type", "PI"]),
    ({"rule": "pessen", "dt": 0.01}, ["--rule", "pessen", "--dt", "0.01"])])
def test_gains_from_the_limit_of_stability_are_those_of_the_program(words, options):
    result = quadtune.pid(Ku=8, Tu=3.6, **words)
    given = ["pid", "--Ku", "8", "--Tu", "3.6", *options]
    assert_prints_as(result, *given)
    assert result.Kp == answer(*given)["Kp"] and result.how == answer(*given)["how"]
    assert result.num is None or len(result.num) == len(result.den)


def test_given_gains_are_discretized_as_by_the_program():
    result = quadtune.pid(gains=[4, 1, 2, 0.05], dt=0.01, integrator="backward-euler")
    given = ["pid", "--gains", "4,1,2,0.05", "--dt", "0.01", "--integrator", "backward-euler"]
    assert_prints_as(result, *given)
    assert_same(result.num, answer(*given)["discrete"]["num"])
    assert result.controller.pid == [4, 1, 2, 0.05]


def test_the_margins_of_the_controller_are_those_of_the_gains():
    result = quadtune.pid(num=1, den=[1, 3, 3, 1], rule="simc", type="PI")
    loop = quadtune.margins(num=1, den=[1, 3, 3, 1], controller=result.controller)
    assert loop.margins.loops[0].Ms == pytest.approx(result.margins.loops[0].Ms, rel=1e-9)


@pytest.mark.parametrize("words, where", [
    ({"Ku": 1, "Tu": 0}, "Tu"), ({"Ku": 1, "Tu": 1, "rule": "simc"}, "rule"),
    ({"Ku": 0, "Tu": 1}, "rule"), ({"Ku": 1, "Tu": 1, "integrator": "euler"}, "integrator"),
    ({"gains": [1, 2, 3, 4, 5], "dt": 0.1}, "gains"), ({"gains": 1, "dt": 0}, "dt"),
    ({"gains": 1, "dt": 0.1, "integrator": "zoh"}, "integrator")])
def test_a_wrong_argument_without_a_plant_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.pid(**words)
    assert refused.value.where == where


@pytest.mark.parametrize("words, options", [
    ({}, []),
    ({"method": "loops", "dt": 0.005}, ["--method", "loops", "--dt", "0.005"]),
    ({"bandwidth": {"roll": 25.5, "x": 2}, "integral": ["x", "y", "altitude"]},
     ["--bandwidth", "roll=25.5,x=2", "--integral", "x,y,altitude"]),
    ({"for_firmware": "px4", "firmware": "1.15"}, ["--for", "px4", "--firmware", "1.15"]),
    ({"rate_lead": 0.01}, ["--rate-lead", "0.01"]),
])
def test_the_cascade_of_a_vehicle_is_that_of_the_program(words, options):
    cascade = quadtune.pid("mambo", **words)
    assert_prints_as(cascade, "pid", "mambo", *options)
    expected = answer("pid", "mambo", *options)
    loops = {loop["name"]: loop for loop in expected["loops"]}
    assert len(cascade.loops) == 6
    for loop in cascade.loops:
        assert (loop.Kp, loop.Ki, loop.Kd) == tuple(
            loops[loop.name][name] for name in ("Kp", "Ki", "Kd"))
    assert cascade.dt == expected["dt"]
    assert cascade.flown.largest_pole == expected["flown_loop"]["largest_pole"]


@pytest.mark.parametrize("words, where", [
    ({}, "crossover"),
    ({"crossover": 1.0}, "phase_margin"),
    ({"rule": "best"}, "rule"),
    ({"rule": "simc", "Tf": 0.1}, "Tf"),
    ({"Ms_max": 1.4, "type": "PDI"}, "type"),
    ({"Ms_max": 1.4, "delay": -1.0}, "delay"),
])
def test_a_wrong_argument_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.pid(num=[1], den=[1, 3, 3, 1], **words)
    assert refused.value.where == where


@pytest.mark.parametrize("words, where", [
    ({"method": "best"}, "method"),
    ({"bandwidth": {"rol": 20}}, "bandwidth"),
    ({"structure": "pi"}, "structure"),
    ({"for_firmware": "px5"}, "for_firmware"),
    ({"setup": "legacy"}, "setup"),
])
def test_a_wrong_word_of_a_cascade_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.pid("mambo", **words)
    assert refused.value.where == where


def test_a_loop_that_cannot_be_had_has_no_solution():
    with pytest.raises(quadtune.NoSolution, match="roll"):
        quadtune.pid("mambo", bandwidth={"roll": 600})
