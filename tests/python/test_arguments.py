# SPDX-License-Identifier: Apache-2.0
"""Calls whose arguments fit no signature: one line that names the argument."""

import numpy as np
import pytest

import quadtune

I = np.eye(2)  # noqa: E741


@pytest.mark.parametrize("call, message", [
    (lambda: quadtune.pid("mambo", bandwith=40),
     "pid() has no argument 'bandwith'; did you mean 'bandwidth'?"),
    (lambda: quadtune.vehicles(quux=1), "vehicles() has no argument 'quux'"),
    (lambda: quadtune.lqr(I, I, I),
     "lqr(): R is missing; expected lqr(vehicle, ...) or lqr(A, B, Q, R, ...)"),
    (lambda: quadtune.kalman(I, I, I), "kalman(): R is missing; expected kalman(A, C, Q, R, ...)"),
    (lambda: quadtune.pid("mambo", 3),
     "pid(): argument 2 is unexpected; expected pid(vehicle, ...) or pid(num=, den=, ...) or "
     "pid(Ku=, Tu=, ...) or pid(gains=, dt=, ...)"),
    (lambda: quadtune.pid("mambo", Ku=3),
     "pid(): Ku cannot be combined with vehicle; expected pid(vehicle, ...) or pid(num=, den=, ...) "
     "or pid(Ku=, Tu=, ...) or pid(gains=, dt=, ...)"),
    (lambda: quadtune.lqr("mambo", vehicle="mambo"),
     "lqr(): vehicle is given twice; expected lqr(vehicle, ...) or lqr(A, B, Q, R, ...)"),
    (lambda: quadtune.lqr(I, I, I, 1), "lqr(): R is 1 (int), expected a matrix, such as "
                                       "[[1, 0], [0, 1]]"),
    (lambda: quadtune.lqr(I, "B.txt", I, I), "lqr(): B is 'B.txt' (str), expected a matrix, such as "
                                             "[[1, 0], [0, 1]]"),
    (lambda: quadtune.lqr("mambo", dt="0.01"), "lqr(): dt is '0.01' (str), expected a number"),
    (lambda: quadtune.certify("out", mass=0.9), "certify(): mass is 0.9 (float), expected two "
                                                "numbers (low, high)"),
    (lambda: quadtune.vehicle(3), "vehicle(): vehicle is 3 (int), expected a built-in vehicle, a "
                                  "vehicle file or a Vehicle"),
    (lambda: quadtune.vehicle(I), "vehicle(): vehicle is a value of type ndarray, expected a "
                                  "built-in vehicle, a vehicle file or a Vehicle"),
    (lambda: quadtune.fly("mambo", seed=-1), "fly(): seed is -1 (int), expected an integer of 0 or "
                                             "more"),
    (lambda: quadtune.tune_kalman("altitude", "log.csv"),
     "tune_kalman(): logs is 'log.csv' (str), expected a list of files or names"),
    (lambda: quadtune.tune_kalman("altitude", ["log.csv"], map="baro"),
     "tune_kalman(): map is 'baro' (str), expected texts by name, such as {'height': 'baro'}"),
    (lambda: quadtune.lqr("mambo", states=3),
     "lqr(): states is 3 (int), expected a name or a list of names"),
    (lambda: quadtune.schedule("mambo", 3),
     "schedule(): grid is 3 (int), expected a grid, such as 'speed=0:0.5:10' or "
     "{'speed': [0, 5, 10]}"),
    (lambda: quadtune.place(I, I, "x"), "place(): poles is 'x' (str), expected a number or a list of "
                                        "numbers"),
    (lambda: quadtune.margins(num=[1], den=[1, 1], controller=5),
     "margins(): controller is 5 (int), expected a Controller"),
    (lambda: quadtune.tune_kalman("altitude", [3]),
     "tune_kalman(): 'altitude' (str), [3] (list) do not have the types or ranges of "
     "tune_kalman(model, logs, ...); help(quadtune.tune_kalman) lists them"),
])
def test_the_message_names_the_argument(call, message):
    with pytest.raises(TypeError) as raised:
        call()
    assert str(raised.value) == message
    assert raised.value.__cause__ is None
    assert raised.value.__context__ is None


def test_valid_calls_and_other_errors_are_unchanged():
    assert quadtune.lqr(A=I, B=I, Q=I, R=I).solved
    assert quadtune.lqr([[0, 1], [0, 0]], [0, 1], I, [[1]]).K.shape == (1, 2)
    with pytest.raises(quadtune.InvalidInput):
        quadtune.lqr(I, I, I, -I)
    assert quadtune.lqr.__doc__.startswith("lqr(")
    assert quadtune.lqr.__name__ == "lqr"


def test_types_of_numpy_are_accepted():
    low, high = np.float64(0.95), np.float32(1.05)
    with pytest.raises(quadtune.FileError):  # the types are right, the folder is absent
        quadtune.certify("no-such-folder", mass=(low, high), seed=np.int64(3))
