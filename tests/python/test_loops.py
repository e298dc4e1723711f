# SPDX-License-Identifier: Apache-2.0
"""Margins and curves of loops."""

import numpy as np
import pytest
from program import answer, assert_prints_as, decibels

import quadtune

NUM, DEN = [25], [1, 10, 10, 10]
OPTIONS = ["margins", "--num", "25", "--den", "1,10,10,10"]


@pytest.mark.parametrize("words, options", [
    ({}, []), ({"delay": 0.01}, ["--delay", "0.01"])])
def test_margins_of_a_transfer_function_are_those_of_the_program(words, options):
    loop = quadtune.margins(num=NUM, den=DEN, **words)
    assert_prints_as(loop, *OPTIONS, *options)
    expected = answer(*OPTIONS, *options)["loops"][0]
    margins = loop.margins.loops[0]
    assert margins.stable == expected["stable"]
    assert margins.Ms == expected["Ms"] and margins.Mt == expected["Mt"]
    assert margins.crossover == expected["crossover"]
    assert margins.delay_margin == expected["delay_margin_s"]
    assert decibels(margins.gain_margin) == expected["gain_margin_db"]
    assert [at.w for at in margins.gain_crossovers] == [
        at["w"] for at in expected["gain_crossovers"]]
    assert margins.disk.alpha == expected["disk_alpha"]


def test_margins_of_a_discrete_transfer_function(tmp_path):
    loop = quadtune.margins(num=[0.1], den=[1, -0.9], dt=0.01, delay=0.02)
    assert_prints_as(loop, "margins", "--num", "0.1", "--den", "1,-0.9", "--dt", "0.01",
                     "--delay", "0.02")
    assert loop.dt == 0.01


@pytest.mark.parametrize("words, options", [
    ({}, []), ({"cut": "states"}, ["--cut", "states"]), ({"sampled": 0.05}, ["--sampled", "0.05"])])
def test_margins_of_a_gain_are_those_of_the_program(words, options):
    A, B, K = [[0, 1], [0, 0]], [[0], [1]], [[1, 1.7]]
    loop = quadtune.margins(A, B, K, **words)
    assert_prints_as(loop, "margins", "--A", "0 1; 0 0", "--B", "0; 1", "--K", "1 1.7", *options)


def test_margins_of_a_vehicle_are_those_of_the_program(tmp_path):
    gains = tmp_path / "gains.json"
    law = quadtune.lqr("crazyflie")
    law.save(gains)
    loop = quadtune.margins("crazyflie", gains)
    assert_prints_as(loop, "margins", "crazyflie", "--gains", gains)
    expected = answer("margins", "crazyflie", "--gains", gains)
    assert loop.flown.stable and loop.flown.largest_pole == expected["flown"]["largest_pole"]
    assert loop.flown.margins.loops[0].Ms == loop.margins.loops[0].Ms
    assert loop.names == [one["name"] for one in expected["ideal"]["loops"]]
    ideal = quadtune.margins("crazyflie", gains, plant="ideal")
    assert_prints_as(ideal, "margins", "crazyflie", "--gains", gains, "--plant", "ideal")
    assert ideal.flown is None


def test_bode_and_nyquist_are_the_response_of_the_loop():
    loop = quadtune.margins(num=NUM, den=DEN, delay=0.01)
    curves = loop.bode()
    s = 1j * curves.w
    expected = np.polyval(NUM, s) / np.polyval(DEN, s) * np.exp(-0.01 * s)
    assert len(curves.w) > 100 and np.all(np.diff(curves.w) > 0)
    assert np.allclose(curves.L, expected, rtol=1e-12, atol=0)
    assert np.allclose(curves.S, 1 / (1 + expected), rtol=1e-9, atol=0)
    assert np.allclose(curves.magnitude_db, 20 * np.log10(abs(expected)), rtol=0, atol=1e-10)
    turns = (curves.phase_deg - np.degrees(np.angle(expected))) / 360
    assert np.allclose(turns, np.round(turns), rtol=0, atol=1e-9)
    assert np.abs(np.diff(curves.phase_deg)).max() < 90
    assert np.array_equal(loop.nyquist().L, curves.L)
    assert np.allclose(loop.response(curves.w), curves.L, rtol=1e-12, atol=0)
    assert np.shares_memory(curves.w, curves.w) and not curves.w.flags.writeable


def test_the_peak_of_the_curve_is_Ms():
    loop = quadtune.margins(num=NUM, den=DEN)
    assert abs(loop.bode().S).max() == pytest.approx(loop.margins.loops[0].Ms, rel=1e-9)


def test_a_step_has_its_closed_form():
    # L = 1/s: y = 1 - exp(-t).
    step = quadtune.margins(num=[1], den=[1, 0]).step(duration=5)
    assert step.t[0] == 0 and step.t[-1] == pytest.approx(5)
    assert np.allclose(step.y, 1 - np.exp(-step.t), rtol=0, atol=1e-12)


def test_channels_by_name():
    A, B = np.zeros((2, 2)), np.eye(2)
    loop = quadtune.margins(A, B, np.diag([1.0, 2.0]))
    assert loop.names == ["u1", "u2"]
    assert np.allclose(loop.response([1.0], "u2"), 2 / 1j)
    assert np.array_equal(loop.bode("u2").L, loop.bode(1).L)
    with pytest.raises(quadtune.InvalidInput) as refused:
        loop.bode("u3")
    assert refused.value.where == "channel"


@pytest.mark.parametrize("call, where", [
    (lambda: quadtune.margins(num=[1], den=[1, 1], delay=-1.0), "delay"),
    (lambda: quadtune.margins(num=[1], den=[1, 1], dt=0.01, delay=0.015), "delay"),
    (lambda: quadtune.margins(num=[1, 0, 0], den=[1, 1]), "num, den"),
    (lambda: quadtune.margins([[0]], [[1]], [[1]], cut="middle"), "cut"),
    (lambda: quadtune.margins([[0]], [[1]], [[1, 2]]), "K"),
    (lambda: quadtune.margins("mambo", "published", plant="real"), "plant"),
    (lambda: quadtune.margins("mambo", "published", height=0.0), "height"),
])
def test_a_wrong_argument_is_named(call, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        call()
    assert refused.value.where == where
