# SPDX-License-Identifier: Apache-2.0
"""LQR, LQI, LQG, Kalman filters and discretization of matrices."""

import numpy as np
import pytest
from program import ROOT, answer, assert_prints_as, assert_same, assert_same_poles

import quadtune

EXAMPLES = ROOT / "docs" / "examples"
A, B, C, Q, R = (np.loadtxt(EXAMPLES / f"{name}.txt", ndmin=2) for name in "ABCQR")
R_LQR = np.eye(B.shape[1])
TIMES = [({}, []), ({"discrete": True}, ["--discrete"]), ({"sampled": 0.01}, ["--sampled", "0.01"])]


def file_of(tmp_path, name, matrix):
    """A matrix as a file that reads back to the same doubles."""
    path = tmp_path / name
    path.write_text("\n".join(" ".join(map(repr, map(float, row))) for row in matrix) + "\n")
    return str(path)


@pytest.mark.parametrize("words, options", TIMES)
def test_lqr_is_that_of_the_program(tmp_path, words, options):
    stable = A if words != {"discrete": True} else np.eye(len(A)) + 0.01 * A
    weights = np.diag(np.arange(1.0, len(A) + 1))
    given = ["lqr", "--A", file_of(tmp_path, "A", stable), "--B", file_of(tmp_path, "B", B),
             "--Q", file_of(tmp_path, "Q", weights), "--R", file_of(tmp_path, "R", R_LQR), *options]
    result = quadtune.lqr(stable, B, weights, R_LQR, **words)
    assert result.solved
    assert_prints_as(result, *given)
    expected = answer(*given)
    assert_same(result.K, expected["K"])
    assert_same(result.S, expected["S"])
    assert_same_poles(result.poles, expected["poles"])
    assert result.riccati.residual == expected["residual"]
    assert result.riccati.rcond == expected["rcond"]
    assert result.margins.loops[0].Ms == expected["margins"]["loops"][0]["Ms"]
    assert result.margins.loops[0].stable


INTEGRATOR = ([[0, 1], [0, 0]], [[0], [1]])
INTEGRATOR_OPTIONS = ["--A", "0 1; 0 0", "--B", "0; 1"]


@pytest.mark.parametrize("words, options", [
    ({}, []), ({"discrete": True}, ["--discrete"]),
    ({"discrete": True, "dt": 0.1, "delay": 2}, ["--discrete", "--dt", "0.1", "--delay", "2"]),
    ({"sampled": 0.05, "delay": 3}, ["--sampled", "0.05", "--delay", "3"])])
def test_lqr_with_integrals_and_delay_is_that_of_the_program(words, options):
    A = INTEGRATOR[0] if "discrete" not in words else [[1, 0.1], [0, 1]]
    given = ["lqr", "--A", "0 1; 0 0" if "discrete" not in words else "1 0.1; 0 1", "--B", "0; 1",
             "--C", "1 0", "--Q", "2 0 0; 0 1 0; 0 0 0.5", "--R", "0.3", *options]
    result = quadtune.lqr(A, INTEGRATOR[1], np.diag([2, 1, 0.5]), [[0.3]], C=[[1, 0]], **words)
    assert_prints_as(result, *given)
    expected = answer(*given)
    assert_same(result.K, expected["K"])
    assert_same(result.K_int, expected["K_int"])
    delay = words.get("delay", 0)
    assert result.K.shape == (1, 2) and result.K_int.shape == (1, 1)
    assert result.K_past.shape == (1, delay)
    if delay:
        assert_same(result.K_past, expected["K_past"])
    if "sampled" in words:
        for name in "ABQRN":
            assert_same(getattr(result.sampled, name), expected["sampled"][name])
    else:
        assert result.sampled is None


@pytest.mark.parametrize("words, where", [
    ({"delay": 1}, "delay"), ({"delay": -1, "discrete": True}, "delay"),
    ({"delay": 2001, "discrete": True}, "delay"), ({"D": [[0]]}, "D"), ({"dt": 0.1}, "dt"),
    ({"dt": 0.0, "discrete": True}, "dt"), ({"evidence": "all"}, "evidence")])
def test_lqr_names_a_wrong_argument(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.lqr(*INTEGRATOR, np.eye(2), [[1]], **words)
    assert refused.value.where == where


def test_integrals_need_their_weights():
    with pytest.raises(quadtune.InvalidInput, match="integrals"):
        quadtune.lqr(*INTEGRATOR, np.eye(2), [[1]], C=[[1, 0]], sampled=0.1)


NOISE = {"noise_Q": [[0.1]], "noise_R": [[0.01]], "G": [[0], [1]]}
LQG_OPTIONS = ["lqg", *INTEGRATOR_OPTIONS, "--C", "1 0", "--Q", "1 0; 0 1", "--R", "0.5",
               "--noise-Q", "0.1", "--noise-R", "0.01", "--G", "0; 1"]


@pytest.mark.parametrize("words, options", [
    ({}, ["--continuous"]), ({"sampled": 0.05}, ["--sampled", "0.05"]),
    ({"sampled": 0.05, "estimate": "delayed"}, ["--sampled", "0.05", "--estimate", "delayed"]),
    ({"discrete": True, "dt": 0.1}, ["--discrete", "--dt", "0.1"])])
def test_lqg_is_that_of_the_program(words, options):
    result = quadtune.lqg(*INTEGRATOR, [[1, 0]], np.eye(2), [[0.5]], **NOISE, **words)
    assert result.solved and not result.culprit
    given = [*LQG_OPTIONS, *options]
    assert_prints_as(result, *given)
    expected = answer(*given)
    for name in ("K", "S", "L", "P"):
        assert_same(getattr(result, name), expected[name])
    for name in "ABCD":
        assert_same(getattr(result.controller, name), expected["controller"][name])
    assert_same_poles(result.poles, expected["poles"])
    assert_same(result.state_rms, expected["rms"]["states"])
    assert_same(result.input_rms, expected["rms"]["inputs"])
    assert result.cost == expected["cost"] and result.dt == (expected["controller"]["dt"] or 0)


def test_margins_with_the_controller_of_lqg_are_those_of_lqg():
    lqg = quadtune.lqg(*INTEGRATOR, [[1, 0]], np.eye(2), [[0.5]], **NOISE, sampled=0.05)
    loop = quadtune.margins(*INTEGRATOR, C=[[1, 0]], controller=lqg.controller, sampled=0.05)
    assert loop.margins.loops[0].Ms == pytest.approx(lqg.margins.loops[0].Ms, rel=1e-9)


def test_lqg_without_solution_is_a_result():
    result = quadtune.lqg(np.diag([1.0, -1.0]), [[1], [1]], [[0, 1]], np.eye(2), [[1]], np.eye(2),
                          [[1]])
    assert not result.solved and "filter" in result.culprit
    with pytest.raises(quadtune.NoSolution, match="filter"):
        result.to_json()


@pytest.mark.parametrize("words, where", [
    ({"estimate": "old", "discrete": True}, "estimate"), ({"estimate": "current"}, "estimate"),
    ({"discrete": True, "sampled": 0.1}, "sampled"), ({"dt": 0.1}, "dt"),
    ({"sampled": -0.1}, "sampled")])
def test_lqg_names_a_wrong_argument(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.lqg(*INTEGRATOR, [[1, 0]], np.eye(2), [[0.5]], **NOISE, **words)
    assert refused.value.where == where


def test_lqr_of_a_double_integrator_has_its_closed_form():
    # x'' = u, weights 1: K = [1, sqrt(3)].
    result = quadtune.lqr([[0, 1], [0, 0]], [[0], [1]], np.eye(2), [[1]])
    assert np.allclose(result.K, [[1, np.sqrt(3)]], rtol=0, atol=1e-14)


def test_lists_and_any_layout_give_the_same():
    fortran = quadtune.lqr(np.asfortranarray(A), np.asfortranarray(B), np.eye(len(A)), R_LQR)
    slices = quadtune.lqr(np.repeat(A, 2, axis=1)[:, ::2], B, np.eye(len(A)), R_LQR)
    lists = quadtune.lqr(A.tolist(), B.tolist(), np.eye(len(A)).tolist(), R_LQR.tolist())
    assert np.isfinite(fortran.K).all()
    assert np.array_equal(fortran.K, slices.K) and np.array_equal(fortran.K, lists.K)


def test_a_problem_without_solution_is_a_result_with_a_status():
    result = quadtune.lqr(np.diag([1.0, -1.0]), [[0], [1]], np.eye(2), [[1]])
    assert not result.solved
    assert result.status == "not stabilizable"
    assert "1" in result.riccati.culprit
    assert np.isnan(result.K).all()
    with pytest.raises(quadtune.NoSolution, match="not stabilizable"):
        result.to_json()


@pytest.mark.parametrize("change, where", [
    ({"B": np.eye(3)}, "B"),
    ({"R": [[-1.0]]}, "R"),
    ({"A": [[np.nan, 0], [0, 0]]}, "A"),
])
def test_a_wrong_matrix_is_refused(change, where):
    problem = {"A": [[0, 1], [0, 0]], "B": [[0], [1]], "Q": np.eye(2), "R": [[1]], **change}
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.lqr(**problem)
    assert where in str(refused.value)
    assert refused.value.where


def test_two_times_are_refused():
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.lqr(A, B, np.eye(len(A)), R_LQR, discrete=True, sampled=0.01)
    assert refused.value.where == "sampled"


@pytest.mark.parametrize("words, options", [
    ({}, ["--continuous"]), ({"discrete": True}, ["--discrete"]),
    ({"sampled": 0.01}, ["--sampled", "0.01"])])
def test_kalman_is_that_of_the_program(tmp_path, words, options):
    model = A if words != {"discrete": True} else np.eye(len(A)) + 0.01 * A
    given = ["kalman", "--A", file_of(tmp_path, "A", model), "--C", file_of(tmp_path, "C", C),
             "--Q", file_of(tmp_path, "Q", Q), "--R", file_of(tmp_path, "R", R), *options]
    result = quadtune.kalman(model, C, Q, R, **words)
    assert result.solved
    assert_prints_as(result, *given)
    expected = answer(*given)
    for name in ("L", "P") if not words else ("L", "P", "M", "Z"):
        assert_same(getattr(result, name), expected[name])
    assert_same_poles(result.poles, expected["poles"])
    assert result.residual == expected["residual"]
    if "sampled" in words:
        for name in "AQR":
            assert_same(getattr(result.sampled, name), expected["sampled"][name])
    else:
        assert result.sampled is None


def test_kalman_without_detection_is_a_result_with_a_status():
    result = quadtune.kalman(np.diag([2.0, 0.5]), [[0, 1]], np.eye(2), [[1]], discrete=True)
    assert result.status == "not detectable"
    assert result.culprit


@pytest.mark.parametrize("method", ["zoh", "foh", "impulse", "euler", "backward-euler", "tustin"])
def test_discretize_is_that_of_the_program(tmp_path, method):
    given = ["discretize", "--A", file_of(tmp_path, "A", A), "--B", file_of(tmp_path, "B", B),
             "--dt", "0.01", "--method", method]
    result = quadtune.discretize(A, B, dt=0.01, method=method)
    assert_prints_as(result, *given)
    expected = answer(*given)
    for name in "ABCD":
        assert_same(getattr(result, name), expected[name])
    assert result.num is None and result.den is None and result.delay is None
    assert result.dt == 0.01 and result.method == method


def test_discretize_of_a_transfer_function_and_back():
    given = ["discretize", "--num", "1", "--den", "1,0.5", "--delay", "0.03", "--dt", "0.01"]
    result = quadtune.discretize(num=1, den=[1, 0.5], delay=0.03, dt=0.01)
    assert_prints_as(result, *given)
    assert_same(result.den, answer(*given)["den"])
    assert result.delay == 3 and result.A is None
    back = quadtune.discretize(num=result.num, den=result.den, dt=0.01, inverse=True)
    assert np.allclose(back.den, [1, 0.5], rtol=1e-12, atol=0)


def test_discretize_with_delays_of_channels(tmp_path):
    given = ["discretize", "--A", file_of(tmp_path, "A", A), "--B", file_of(tmp_path, "B", B),
             "--dt", "0.01", "--input-delay", "0.013"]
    assert_prints_as(quadtune.discretize(A, B, dt=0.01, input_delay=0.013), *given)


@pytest.mark.parametrize("words, where", [
    ({"dt": 0.0}, "dt"),
    ({"dt": 0.01, "method": "zho"}, "method"),
    ({"dt": 0.01, "prewarp": 3.0}, "prewarp"),
    ({"dt": 0.01, "method": "foh", "inverse": True}, "inverse"),
    ({"dt": 0.01, "input_delay": [0.1, 0.2, 0.3, 0.4, 0.5]}, "input_delay"),
    ({"dt": 0.01, "inverse": True, "output_delay": 0.1}, "output_delay"),
])
def test_discretize_names_a_wrong_argument(words, where):
    with pytest.raises(quadtune.InvalidInput) as refused:
        quadtune.discretize(A, B, **words)
    assert refused.value.where == where


def test_compare_methods_is_that_of_the_program():
    result = quadtune.compare_methods("mambo", 0.005, plant="ideal")
    assert_prints_as(result, "discretize", "mambo", "--compare", "--dt", "0.005",
                     "--plant", "ideal")
    assert list(result.periods) == [0.0025, 0.005, 0.01]
