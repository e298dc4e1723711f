# SPDX-License-Identifier: Apache-2.0
"""Gain schedules."""

import itertools
import json

import numpy as np
import pytest
from program import answer, assert_same, printed

import quadtune

GRID = {"speed": [0, 2, 4], "yaw_rate": [-1.0, 0.0, 1.0]}
TEXT = "speed=0:2:4, yaw_rate=-1:1:1"
OPTIONS = ["lqr", "mambo", "--schedule", TEXT, "--method", "sampled", "--dt", "0.01",
           "--integral", "yaw"]


@pytest.fixture(scope="module")
def schedule():
    return quadtune.schedule("mambo", GRID, method="sampled", dt=0.01, integral="yaw")


def test_a_schedule_is_that_of_the_program(schedule):
    assert schedule.to_json() + "\n" == printed(*OPTIONS)
    assert schedule.to_dict() == answer(*OPTIONS)
    assert quadtune.schedule("mambo", TEXT, method="sampled", dt=0.01, integral=["yaw"],
                             threads=1).to_json() == schedule.to_json()


def test_arrays_have_the_shape_of_the_grid(schedule):
    assert schedule.axes == {"speed": [0, 2, 4], "yaw_rate": [-1, 0, 1]}
    nx, nu = len(schedule.states), len(schedule.inputs)
    assert schedule.K.shape == (3, 3, nu, nx) and schedule.K_int.shape == (3, 3, nu, 1)
    assert schedule.x0.shape == (3, 3, nx) and schedule.u0.shape == (3, 3, nu)
    assert schedule.integrals == ["yaw"] and schedule.dt == 0.01 and schedule.vehicle == "mambo"
    points = answer(*OPTIONS)["points"]
    assert len(points) == len(schedule.status) == 9
    for (i, j), point, status in zip(itertools.product(range(3), range(3)), points,
                                     schedule.status):
        assert status == "solved"
        assert_same(schedule.K[i, j], point["K"])
        assert_same(schedule.K_int[i, j], point["K_int"])
        assert_same(schedule.x0[i, j], point["x0"])
        assert_same(schedule.u0[i, j], point["u0"])


def test_arrays_are_views_that_cannot_be_written_to(schedule):
    assert np.shares_memory(schedule.K, schedule.K)
    with pytest.raises(ValueError):
        schedule.K[0, 0, 0, 0] = 1


def test_gains_between_the_points(schedule):
    at = schedule.at([2, 0])
    assert at.found and np.array_equal(at.K, schedule.K[1, 1])
    between = schedule.at([1, 0])
    assert np.allclose(between.K, (schedule.K[0, 1] + schedule.K[1, 1]) / 2, rtol=1e-12, atol=0)
    outside = schedule.at([5, 0])
    assert not outside.found and "speed" in outside.culprit
    with pytest.raises(quadtune.InvalidInput):
        schedule.at([1])


@pytest.mark.parametrize("name", ["table.toml", "table.json"])
def test_a_saved_table_reads_back_and_flies(schedule, tmp_path, name):
    file = tmp_path / name
    schedule.save(file)
    again = quadtune.load_schedule(file)
    assert again.to_json() == schedule.to_json()
    if name.endswith(".json"):
        assert json.loads(file.read_text()) == schedule.to_dict()
        flight = quadtune.fly("mambo", gains=file, duration=1, log=False)
        assert flight.end_time == pytest.approx(1)


def test_a_point_that_cannot_be_flown_has_no_gain():
    schedule = quadtune.schedule("mambo", {"mass": [1, 10]}, method="discrete", dt=0.01)
    assert schedule.status == ["solved", "no trim"] and schedule.culprits[1]
    assert np.isfinite(schedule.K[0]).all() and np.isnan(schedule.K[1]).all()
    assert any("warning" in line for line in schedule.messages)
    assert "mass" in str(schedule)
    with pytest.raises(quadtune.NoSolution):
        quadtune.schedule("mambo", {"mass": 10})


@pytest.mark.parametrize("words, where", [
    ({"grid": "speed=0:2"}, "grid"),
    ({"grid": {"height": [1]}}, "grid"),
    ({"grid": {"speed": [2, 1]}}, "grid"),
    ({"grid": {"speed": [-1]}}, "grid"),
    ({"grid": {}}, "grid"),
    ({"Q": [1, 2, 3]}, "Q"),
    ({"R": -1.0}, "R"),
    ({"method": "sampled"}, "dt"),
    ({"method": "exact"}, "method"),
    ({"integral": "altitude"}, "integral"),
    ({"convention": "enu"}, "convention"),
])
def test_a_wrong_argument_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.schedule("mambo", **{"grid": {"speed": [0]}, **words})
    assert refused.value.where.startswith(where)


def test_a_wrong_table_is_named(schedule, tmp_path):
    with pytest.raises(quadtune.InvalidInput) as refused:
        schedule.save(tmp_path / "table.txt")
    assert refused.value.where == "file"
    (tmp_path / "bad.toml").write_text("format = 1\n")
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.load_schedule(tmp_path / "bad.toml")
    assert "bad.toml" in refused.value.where
    with pytest.raises(quadtune.FileError):
        quadtune.load_schedule(tmp_path / "absent.toml")
