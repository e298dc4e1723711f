# SPDX-License-Identifier: Apache-2.0
"""Flights."""

import csv
import gc
import math

import numpy as np
import pytest
from program import answer, without

import quadtune


def same_flight(flight, *options):
    """The flight's JSON is that of the program, but for the time that it took to compute."""
    expected = answer("fly", *options)
    assert without(flight.to_dict(), "wall_s") == without(expected, "wall_s")
    return expected


def test_a_flight_is_that_of_the_program():
    flight = quadtune.fly("mambo", duration=16, seed=3)
    expected = same_flight(flight, "mambo", "--duration", "16", "--seed", "3")
    assert flight.passed == (expected["verdict"] == "pass")
    assert flight.end == expected["end"] == "completed"
    assert flight.end_time == expected["end_time_s"]
    assert flight.law == expected["law"] and flight.estimator == expected["estimator"]
    assert len(flight.metrics) > 10
    for name, value in flight.metrics.items():
        # The key has the unit behind the name; what was not reached is null.
        printed = [number for key, number in expected["metrics"].items()
                   if name in (key, key.rsplit("_", 1)[0])]
        assert printed == [None if math.isinf(value) else value]
    assert [(check.metric, check.ok) for check in flight.checks] == [
        (limit["metric"], limit["ok"]) for limit in expected["limits"]]
    assert list(flight.final_state) == list(expected["final_state"].values())


def test_the_record_is_the_log_that_the_program_writes(tmp_path):
    log = tmp_path / "flight.csv"
    answer("fly", "crazyflie", "--mission", "step-north", "--duration", "6", "--log", log)
    flight = quadtune.fly("crazyflie", mission="step-north", duration=6)
    flight.save_log(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == log.read_bytes()
    rows = [row for row in csv.reader(log.open()) if row and not row[0].startswith("#")]
    header = rows[0]
    values = np.array([[float(cell or "nan") for cell in row] for row in rows[1:]])
    for name in ("t", "x.px", "x.pz", "estimate.px"):
        assert name in flight and name in flight.columns
        place = [i for i, title in enumerate(header) if title.split("[")[0].strip() == name]
        column = values[:, place[0]]
        assert np.isfinite(column).all() and len(column) > 100
        assert np.array_equal(flight[name], column)
    assert flight.units["x.px"] == "m"


def test_columns_are_views_that_outlive_their_flight():
    flight = quadtune.fly("mambo", duration=3)
    t = flight["t"]
    assert np.shares_memory(t, flight["t"]) and not t.flags.writeable
    expected = t.copy()
    del flight
    gc.collect()
    assert len(t) > 100 and np.array_equal(t, expected)
    assert np.all(np.diff(t) > 0)


def test_the_record_does_not_change_the_flight():
    with_log = quadtune.fly("mambo", duration=4)
    without_log = quadtune.fly("mambo", duration=4, log=False)
    assert without_log.columns == []
    assert without(with_log.to_dict(), "wall_s") == without(without_log.to_dict(), "wall_s")
    with pytest.raises(KeyError, match="log=False"):
        without_log["t"]


def test_seeds_give_a_list():
    flights = quadtune.fly("mambo", duration=4, seed=7, seeds=3, log=False, diagnose=False)
    assert [flight.seed for flight in flights] == [7, 8, 9]
    alone = quadtune.fly("mambo", duration=4, seed=8, log=False, diagnose=False)
    assert without(flights[1].to_dict(), "wall_s") == without(alone.to_dict(), "wall_s")


def test_a_flight_that_fails_says_why():
    flight = quadtune.fly("mambo", mission="step-north", wind="north=12", duration=8)
    expected = same_flight(flight, "mambo", "--mission", "step-north", "--wind", "north=12",
                           "--duration", "8")
    assert not flight.passed
    assert flight.reasons == expected["reasons"] and flight.reasons
    assert flight.diagnosis.cause == expected["diagnosis"]["cause"]
    assert flight.diagnosis.next
    undiagnosed = quadtune.fly("mambo", mission="step-north", wind="north=12", duration=8,
                               diagnose=False)
    assert undiagnosed.diagnosis is None


def test_gains_of_a_result_are_flown(tmp_path):
    gains = tmp_path / "gains.json"
    quadtune.lqr("mambo").save(gains)
    flight = quadtune.fly("mambo", gains=gains, duration=16)
    same_flight(flight, "mambo", "--gains", gains, "--duration", "16")
    assert flight.passed


def test_a_page_is_written(tmp_path):
    page = tmp_path / "flight.html"
    quadtune.fly("mambo", duration=3).save_report(page)
    assert page.read_text().startswith("<!")


@pytest.mark.parametrize("words, where", [
    ({"sensors": "perfect"}, "sensors"),
    ({"estimator": "none"}, "estimator"),
    ({"wind": "hurricane"}, "wind"),
    ({"duration": -1.0}, "duration"),
    ({"controller": "fuzzy"}, "controller"),
    ({"solver": "leapfrog"}, "solver"),
    ({"seeds": 0}, "seeds"),
])
def test_a_wrong_argument_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.fly("mambo", **words)
    assert refused.value.where == where


def test_an_unknown_mission_is_named():
    with pytest.raises((quadtune.InvalidInput, quadtune.FileError), match="hovr"):
        quadtune.fly("mambo", mission="hovr")
