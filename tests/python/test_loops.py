# SPDX-License-Identifier: Apache-2.0
"""Margins and curves of loops."""

import numpy as np
import pytest
from program import answer, assert_prints_as, decibels

import quadtune

NUM, DEN = [25], [1, 10, 10, 10]
OPTIONS = ["margins", "--num", "25", "--den", "1,10,10,10"]


@pytest.mark.parametrize("words, options", [
    ({}, []), ({"delay": 0.01}, ["--delay", "0.01"]), ({"skew": 1}, ["--skew", "1"])])
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


PLANT = ([[-1, 1], [0, -2]], [[1, 0.5], [0, 1]])
OUTPUTS = [[1, 0], [1, 1]]
PLANT_OPTIONS = ["margins", "--A", "-1 1; 0 -2", "--B", "1 0.5; 0 1", "--C", "1 0; 1 1"]


@pytest.mark.parametrize("words, options", [
    ({}, []), ({"D": [[0.1, 0], [0, 0.2]]}, ["--D", "0.1 0; 0 0.2"]),
    ({"sampled": 0.01, "delay": 0.02}, ["--sampled", "0.01", "--delay", "0.02"]),
    ({"skew": -1}, ["--skew", "-1"])])
def test_margins_of_matrices_are_those_of_the_program(words, options):
    loop = quadtune.margins(*PLANT, C=OUTPUTS, **words)
    assert_prints_as(loop, *PLANT_OPTIONS, *options)
    assert loop.names == ["y1", "y2"] and loop.skew == words.get("skew", 0)
    assert "y2: Ms" in str(loop)


@pytest.mark.parametrize("cut, names", [("inputs", ["u1", "u2"]), ("outputs", ["y1", "y2"])])
def test_margins_of_a_controller_times_a_plant(cut, names):
    controller = quadtune.Controller(D=[[2, 0], [0, 1]])
    loop = quadtune.margins(*PLANT, C=OUTPUTS, controller=controller, cut=cut)
    assert_prints_as(loop, *PLANT_OPTIONS, "--controller-D", "2 0; 0 1", "--cut", cut)
    assert loop.names == names


@pytest.mark.parametrize("words, options", [
    ({"num": [5, 5], "den": [1, 1]}, ["--controller-num", "5,5", "--controller-den", "1,1"]),
    ({"A": [[-1]], "B": [[1]], "C": [[2]]},
     ["--controller-A", "-1", "--controller-B", "1", "--controller-C", "2"]),
    ({"pid": [4, 1, 2, 0.02]}, ["--pid", "4,1,2,0.02"]),
    ({"pid": 3.0}, ["--pid", "3"])])
def test_controllers_of_every_kind(words, options):
    controller = quadtune.Controller(**words)
    loop = quadtune.margins(num=[1], den=[1, 3, 2], controller=controller)
    assert_prints_as(loop, "margins", "--num", "1", "--den", "1,3,2", *options)


def test_a_pid_controller_of_a_sampled_loop_is_discretized():
    A, B, C = [[0, 1], [0, -1]], [[0], [1]], [[1, 0]]
    options = ["margins", "--A", "0 1; 0 -1", "--B", "0; 1", "--C", "1 0", "--sampled", "0.01",
               "--pid", "4,1,2,0.02"]
    for integrator in ("tustin", "euler", "backward-euler"):
        controller = quadtune.Controller(pid=[4, 1, 2, 0.02], integrator=integrator)
        loop = quadtune.margins(A, B, C=C, controller=controller, sampled=0.01)
        assert_prints_as(loop, *options, "--integrator", integrator)
        assert loop.dt == 0.01 and loop.margins.loops[0].stable


@pytest.mark.parametrize("words, where", [
    ({}, "num"), ({"num": [1]}, "den"), ({"A": [[1]], "D": [[1]]}, "B"),
    ({"num": [1], "den": [1, 1], "D": [[1]]}, "num"), ({"pid": [1, 2, 3, 4, 5]}, "pid"),
    ({"pid": [1, 0, 1, -1]}, "pid"), ({"pid": [1], "integrator": "zoh"}, "integrator")])
def test_an_incomplete_controller_is_refused(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.Controller(**words)
    assert refused.value.where == where


def frequency_response(closed):
    w = 0.05 * 1000 ** (np.arange(401) / 400)
    L = 25 / np.polyval(DEN, 1j * w)
    return w, L / (1 + L) if closed else L


@pytest.mark.parametrize("closed", [False, True])
def test_margins_of_data_are_those_of_the_program(tmp_path, closed):
    w, G = frequency_response(closed)
    file = tmp_path / "data.csv"
    file.write_text("w,re,im\n" + "".join(
        f"{a!r},{b!r},{c!r}\n" for a, b, c in zip(w.tolist(), G.real.tolist(), G.imag.tolist())))
    measured = "T" if closed else "loop"
    loop = quadtune.margins(w=w, G=G, measured=measured)
    options = ["margins", "--frd", file, "--measured", measured]
    assert_prints_as(loop, *options)
    assert_prints_as(quadtune.margins(frd=file, measured=measured), *options)
    controller = quadtune.Controller(pid=[0.5, 0.1])
    assert_prints_as(quadtune.margins(frd=file, measured=measured, controller=controller,
                                      delay=0.01, skew=1),
                     *options, "--pid", "0.5,0.1", "--delay", "0.01", "--skew", "1")
    assert loop.samples == 401 and loop.w_min == w[0] and loop.w_max == w[-1]
    assert loop.crosses_gain and loop.crosses_phase and loop.largest_phase_step < 0.1
    exact = quadtune.margins(num=NUM, den=DEN).margins.loops[0]
    assert loop.margins.loops[0].Ms == pytest.approx(exact.Ms, rel=1e-3)
    assert loop.margins.loops[0].gain_margin == pytest.approx(exact.gain_margin, rel=1e-3)


def test_what_the_data_leave_open_is_infinite():
    loop = quadtune.margins(w=[1, 2], G=[0.3 - 0.4j, 0.1 - 0.2j])
    assert not loop.crosses_gain and np.isinf(loop.margins.loops[0].gain_margin)
    assert any("does not pass 1" in note for note in loop.notes)


@pytest.mark.parametrize("words, where", [
    ({"w": [1, 2], "G": [1]}, "G"), ({"w": [2, 1], "G": [1, 1]}, "w, G"),
    ({"w": [1, 2], "G": [1, 1], "measured": "L"}, "measured"),
    ({"w": [1, 2], "G": [1, 1], "delay": -1}, "delay")])
def test_wrong_data_are_refused(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.margins(**words)
    assert refused.value.where == where


def test_a_wrong_file_of_data_is_named_by_line(tmp_path):
    (tmp_path / "bad.csv").write_text("w,re,im\n1,2,3\n1,2,3\n")
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.margins(frd=tmp_path / "bad.csv")
    assert refused.value.where.endswith("bad.csv:3")
    with pytest.raises(quadtune.FileError):
        quadtune.margins(frd=tmp_path / "absent.csv")


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
    options = ["margins", "crazyflie", "--gains", gains, "--plant", "ideal"]
    assert_prints_as(ideal, *options)
    assert_prints_as(quadtune.margins("crazyflie", gains, plant="ideal", skew=1), *options,
                     "--skew", "1")
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
    (lambda: quadtune.margins("mambo", "published", skew=1.0), "skew"),
    (lambda: quadtune.margins([[0]], [[1]], C=[[1]], cut="states"), "cut"),
    (lambda: quadtune.margins([[0]], [[1]], C=[[1]], dt=0.1, sampled=0.1), "sampled"),
    (lambda: quadtune.margins([[0]], [[1]], C=[[1, 2]]), "A, B, C, D"),
    (lambda: quadtune.margins(num=[1], den=[1, 1], cut="outputs"), "cut"),
])
def test_a_wrong_argument_is_named(call, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        call()
    assert refused.value.where == where
