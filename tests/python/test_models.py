# SPDX-License-Identifier: Apache-2.0
"""Vehicles and linear models."""

import gc
import os
from pathlib import Path

import numpy as np
import pytest
from program import ROOT, answer, assert_prints_as, assert_same

import quadtune


def test_vehicles_are_those_of_the_program():
    assert quadtune.vehicles() == answer("vehicle", "list")["vehicles"]


@pytest.mark.parametrize("name", quadtune.vehicles())
def test_a_vehicle_is_what_show_prints(name):
    vehicle = quadtune.vehicle(name)
    assert_prints_as(vehicle, "vehicle", "show", name)
    assert vehicle.name == name
    body = answer("vehicle", "show", name)["body"]
    assert vehicle.mass == body["mass_kg"]
    assert_same(vehicle.inertia, body["inertia_kg_m2"])
    assert len(vehicle.rotors) >= 4


def test_a_vehicle_may_be_a_path_or_a_vehicle():
    path = ROOT / "vehicles" / "mambo.toml"
    expected = quadtune.linearize("mambo").A
    for vehicle in (path, os.fspath(path), quadtune.vehicle("mambo"), quadtune.vehicle(path)):
        assert np.array_equal(quadtune.linearize(vehicle).A, expected)


def test_check_vehicle_hovers():
    check = quadtune.check_vehicle("mambo")
    assert check.hover.solved and check.hover.status == "solved"
    assert np.isfinite(check.hover.u).all()
    # m g is what the four rotors give.
    assert check.hover.thrust.sum() == pytest.approx(
        check.vehicle.mass * check.vehicle.gravity, rel=1e-9)


@pytest.mark.parametrize("words, options", [
    ({}, []),
    ({"convention": "uquad", "inputs": "wrench"}, ["--convention", "uquad", "--inputs", "wrench"]),
    ({"at": "circle", "speed": 1.5, "radius": 2.0, "yaw": 0.3},
     ["--at", "circle", "--speed", "1.5", "--radius", "2.0", "--yaw", "0.3"]),
    ({"states": ["pz", "w"], "inputs": "rotor-thrust"},
     ["--states", "pz,w", "--inputs", "rotor-thrust"]),
])
def test_linearize_is_that_of_the_program(words, options):
    model = quadtune.linearize("uquad", **words)
    assert_prints_as(model, "linearize", "uquad", *options)
    expected = answer("linearize", "uquad", *options)
    assert_same(model.A, expected["A"])
    assert_same(model.B, expected["B"])
    assert_same(model.x0, expected["trim"]["x"])
    assert_same(model.u0, expected["trim"]["u"])
    assert model.trim.residual == expected["trim"]["residual"]
    assert [{"name": name, "unit": unit} for name, unit in
            zip(model.states, model.state_units)] == expected["states"]
    assert [{"name": name, "unit": unit} for name, unit in
            zip(model.inputs, model.input_units)] == expected["inputs"]


def test_arrays_are_views_that_cannot_be_written_and_outlive_their_result():
    model = quadtune.linearize("mambo")
    A = model.A
    assert np.shares_memory(A, model.A)
    assert not A.flags.writeable
    with pytest.raises(ValueError):
        A[0, 0] = 1
    expected = A.copy()
    del model
    gc.collect()
    assert np.array_equal(A, expected)


@pytest.mark.parametrize("words, where", [
    ({"at": "loop"}, "at"),
    ({"convention": "enu"}, "convention"),
    ({"inputs": "volts"}, "inputs"),
    ({"states": "px,nothing"}, "states"),
    ({"at": "circle", "speed": 1.0}, "radius"),
    ({"at": "spin"}, "yaw_rate"),
    ({"at": "line", "speed": -1.0}, "at=line"),
])
def test_a_wrong_argument_is_named(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.linearize("mambo", **words)
    assert refused.value.where == where
    assert isinstance(refused.value, ValueError)


def test_a_wrong_line_of_a_file_is_named(tmp_path):
    text = (ROOT / "vehicles" / "mambo.toml").read_text()
    file = tmp_path / "wrong.toml"
    file.write_text(text.replace("mass_kg", "mass_g"))
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.vehicle(file)
    line = [number for number, line in enumerate(text.split("\n"), 1) if "mass_kg" in line][0]
    assert refused.value.where == f"{file}:{line}"
    assert "mass_g" in str(refused.value)


def test_an_absent_file_is_an_error_of_the_system():
    with pytest.raises(quadtune.FileError) as refused:
        quadtune.vehicle(Path("/absent/vehicle.toml"))
    assert isinstance(refused.value, OSError)
    assert refused.value.where == "/absent/vehicle.toml"


def test_a_flight_that_there_is_not_has_no_solution():
    with pytest.raises(quadtune.NoSolution) as refused:
        quadtune.linearize("mambo", at="circle", speed=50.0, radius=1.0)
    assert isinstance(refused.value, ArithmeticError)
    assert refused.value.where == "mambo"


def test_str_is_the_text_of_the_command():
    assert "trim x" in str(quadtune.linearize("mambo"))
    assert str(quadtune.vehicle("mambo")).startswith("vehicle")
