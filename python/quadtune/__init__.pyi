# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union, overload

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]
Path = Union[str, os.PathLike[str]]
VehicleLike = Union[str, os.PathLike[str], "Vehicle"]
Numbers = Union[float, Sequence[float], Array]
ComplexNumbers = Union[complex, Sequence[complex], Array, ComplexArray]
Grid = Union[str, Mapping[str, Union[float, Sequence[float], Array]]]
Names = Union[str, Sequence[str]]
ByLoop = Union[float, str, Mapping[str, float]]

__version__: str

class Campaign:
    """Many flights with drawn parameters."""

    @property
    def name(self) -> str:
        """Its name."""
    @property
    def folder(self) -> str:
        """Where plan, flights and tables are."""
    @property
    def files(self) -> List[str]:
        """What was written."""
    def __len__(self) -> int:
        """Number of flights."""
    @property
    def designs(self) -> List[str]:
        """Name of the design of each case; flight n is of case n % len(designs)."""
    @property
    def missions(self) -> List[str]:
        """Name of the mission of each case."""
    @property
    def passed(self) -> BoolArray:
        """Whether each flight passed."""
    @property
    def end_time(self) -> Array:
        """How long each flight was flown [s]."""
    @property
    def metrics(self) -> List[str]:
        """Names of the metrics."""
    def __getitem__(self, metric: str) -> Array:
        """A metric of every flight as an array; NaN where a flight does not have it."""
    @property
    def quantities(self) -> List[str]:
        """Names of what is drawn."""
    @property
    def drawn(self) -> Array:
        """What was drawn for each flight."""
    def replay(self, number: int, log: bool = True) -> Flight:
        """Fly one flight of the campaign again."""
    def to_json(self) -> str:
        """The text that `quadtune campaign merge DIR --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune campaign merge DIR --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune campaign merge DIR --json -o FILE` writes."""

class Cascade:
    """The PID cascade of a vehicle, with the evidence of its loops."""

    @property
    def loops(self) -> List[PidLoop]:
        """PidLoop of x, y, pitch, roll, yaw and altitude."""
    @property
    def dt(self) -> float:
        """Sample period [s]."""
    @property
    def poles(self) -> ComplexArray:
        """Of all loops closed, on the ideal plant."""
    @property
    def margins(self) -> MarginsReport:
        """Of all loops, cut at the wrench."""
    @property
    def flown(self) -> Optional[FlownLoop]:
        """FlownLoop about a hover, or None where it is not analysed."""
    @property
    def messages(self) -> List[str]:
        """"note: ..." and "warning: ..."."""
    def to_json(self) -> str:
        """The text that `quadtune pid V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune pid V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune pid V --json -o FILE` writes."""

class Certificate:
    """Whether the loops of an export are stable for a box of vehicles."""

    @property
    def proved(self) -> bool:
        """Whether every law is."""
    @property
    def verdict(self) -> str:
        """"proved", "unstable" or "not proved"."""
    @property
    def vehicle(self) -> str:
        """Name of the vehicle."""
    @property
    def laws(self) -> List[CertifiedLaw]:
        """CertifiedLaw of each law."""
    def to_json(self) -> str:
        """The text that `quadtune certify DIR --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune certify DIR --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune certify DIR --json -o FILE` writes."""

class CertifiedLaw:
    """What was proved of one law of an export."""

    @property
    def name(self) -> str:
        """"state feedback" or "cascade"."""
    @property
    def dt(self) -> float:
        """Control period [s]."""
    @property
    def proved(self) -> bool:
        """Whether the whole box is."""
    @property
    def reason(self) -> str:
        """Why not; empty if it is."""
    @property
    def gap(self) -> float:
        """By how much every loop contracts a period at least."""
    @property
    def boxes(self) -> int:
        """Boxes that the proofs inspected."""
    @property
    def worst_radius(self) -> float:
        """Largest spectral radius that the search found in the box."""
    @property
    def proved_scale(self) -> float:
        """Scale of the largest box that was proved."""
    @property
    def found_scale(self) -> float:
        """Scale of the smallest box with an unstable loop; infinite for none."""

class Controller:
    """A controller from the output y of a plant to -u, for margins().

One of: a transfer function; matrices; a constant gain; a PID controller. In a
continuous loop it is continuous, in a discrete loop discrete with the sample period of
the loop."""

    def __init__(self, A: Optional[npt.ArrayLike] = None, B: Optional[npt.ArrayLike] = None, C: Optional[npt.ArrayLike] = None, D: Optional[npt.ArrayLike] = None, *, num: Optional[Numbers] = None, den: Optional[Numbers] = None, pid: Optional[Numbers] = None, integrator: str = 'tustin') -> None:
        """Define a controller in one of four ways.

        A (nc, nc), B (nc, ny), C (nu, nc) and D (nu, ny) or None for zero, where ny and nu are
        the numbers of outputs and inputs of the plant. D alone: a constant gain. num, den:
        coefficients in descending powers of s, or of z in a discrete loop, for ny = nu = 1.
        pid: the gains Kp, Ki [1/s], Kd [s] and the time constant Tf >= 0 [s] of the filter of
        the derivative, the last of which may be omitted. integrator: "euler",
        "backward-euler" or "tustin", by which a discrete loop discretizes pid. Raises
        InvalidInput unless one of the ways is complete; margins() checks the shapes."""
    @property
    def A(self) -> Array:
        """(nc, nc); empty unless the controller has matrices."""
    @property
    def B(self) -> Array:
        """(nc, ny); empty unless the controller has matrices."""
    @property
    def C(self) -> Array:
        """(nu, nc); empty unless the controller has matrices."""
    @property
    def D(self) -> Array:
        """(nu, ny); empty for zero."""
    @property
    def num(self) -> Array:
        """Numerator; empty unless a transfer function."""
    @property
    def den(self) -> Array:
        """Denominator; empty unless a transfer function."""
    @property
    def pid(self) -> Optional[List[float]]:
        """Kp, Ki [1/s], Kd [s] and Tf [s], or None unless a PID controller."""

class Design:
    """What a design file leads to."""

    @property
    def passed(self) -> bool:
        """Whether the loops hold, every mission passed and every export reads back right."""
    @property
    def failure(self) -> str:
        """Why not; empty if it passed."""
    @property
    def gains(self) -> Optional[Gains]:
        """The state feedback, or None."""
    @property
    def loops(self) -> List[PidLoop]:
        """The loops of the PID cascade, if there is one."""
    @property
    def poles(self) -> ComplexArray:
        """(n) of the loop as it is sampled."""
    @property
    def margins(self) -> Optional[MarginsReport]:
        """At the inputs of the plant, or None."""
    @property
    def model(self) -> Linearization:
        """The linear model."""
    @property
    def flights(self) -> List[Flight]:
        """A Flight of each mission: the worst of its seeds."""
    @property
    def disturbed(self) -> List[Flight]:
        """The same missions with a gust and with a load."""
    @property
    def files(self) -> List[ExportedFile]:
        """ExportedFile of everything that was written."""
    @property
    def warnings(self) -> List[str]:
        """Warnings to consider before flying."""
    @property
    def notes(self) -> List[str]:
        """Notes on the model and the flights."""
    def to_json(self) -> str:
        """The text that `quadtune design FILE --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune design FILE --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune design FILE --json -o FILE` writes."""

class Diagnosis:
    """Why a flight failed, and what helps."""

    @property
    def cause(self) -> str:
        """"unstable loop", "motor limits", ..."""
    @property
    def why(self) -> str:
        """The mechanism, with its numbers."""
    @property
    def next(self) -> str:
        """What helps."""

class DiskMargin:
    """The largest disk of complex factors that leaves the loop stable."""

    @property
    def alpha(self) -> float:
        """Size of the disk; 0 of an unstable loop."""
    @property
    def w(self) -> float:
        """Frequency of the worst factor [rad/s]."""
    @property
    def gain_low(self) -> float:
        """Smallest real factor of the disk."""
    @property
    def gain_high(self) -> float:
        """Largest real factor of the disk."""
    @property
    def phase(self) -> float:
        """Phase of the disk, either way [rad]."""

class Export:
    """Files that were written for another program."""

    @property
    def directory(self) -> str:
        """Where they are."""
    @property
    def files(self) -> List[ExportedFile]:
        """ExportedFile of each, the manifest last."""
    @property
    def notes(self) -> List[str]:
        """What the program changes of the gains."""
    def to_json(self) -> str:
        """The text that `quadtune export --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune export --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune export --json -o FILE` writes."""

class ExportedFile:
    """One file of an export."""

    @property
    def path(self) -> str:
        """Name within the export."""
    @property
    def sha256(self) -> str:
        """Hash of its bytes."""
    @property
    def size(self) -> int:
        """Size in bytes."""

class FileError(OSError):
    """A file could not be read or written. `where` is its path."""

    where: str

class FittedParameter:
    """A noise parameter with its interval."""

    @property
    def name(self) -> str:
        """Its name in the filter model."""
    @property
    def unit(self) -> str:
        """Of the variance."""
    @property
    def value(self) -> float:
        """The variance, or an entry of a matrix."""
    @property
    def low(self) -> float:
        """Lower end of the interval."""
    @property
    def high(self) -> float:
        """Upper end of the interval; may be NaN."""
    @property
    def verdict(self) -> str:
        """"determined", "at zero", "not determined", ..."""

class Flight:
    """A simulated flight and its verdict."""

    @property
    def passed(self) -> bool:
        """Whether it completed and kept every limit of its mission."""
    @property
    def end(self) -> str:
        """"completed", "safety exit" or "diverged"."""
    @property
    def end_time(self) -> float:
        """How long it was flown [s]."""
    @property
    def reasons(self) -> List[str]:
        """Why it did not pass, a sentence each."""
    @property
    def metrics(self) -> dict:
        """The figures of the flight by name, in SI units; one that was not reached is infinite."""
    @property
    def checks(self) -> List[LimitCheck]:
        """The limits of the mission."""
    @property
    def events(self) -> List[FlightEvent]:
        """What happened, in the order of time."""
    @property
    def law(self) -> str:
        """The control law in words."""
    @property
    def estimator(self) -> str:
        """Name of the estimator."""
    @property
    def seed(self) -> int:
        """Its seed."""
    @property
    def notes(self) -> List[str]:
        """Notes on choices that were made for the flight."""
    @property
    def diagnosis(self) -> Optional[Diagnosis]:
        """Of a flight that failed, otherwise None."""
    @property
    def final_state(self) -> Array:
        """True state at the end."""
    @property
    def columns(self) -> List[str]:
        """Names of the recorded columns, "t" first; empty with log=False."""
    @property
    def units(self) -> dict:
        """Their units by name."""
    def __getitem__(self, name: str) -> Array:
        """A column as an array with one value a control period, without a copy."""
    def __contains__(self, name: str) -> bool:
        """Whether there is such a column."""
    def save_log(self, file: Path) -> None:
        """Write the record to a .csv or .mat file, as `quadtune fly --log FILE`."""
    def save_report(self, file: Path) -> None:
        """Write the page of the flight, as `quadtune fly --report FILE`."""
    def to_json(self) -> str:
        """The text that `quadtune fly V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune fly V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune fly V --json -o FILE` writes."""

class FlightEvent:
    """Something that happened in a flight."""

    @property
    def time(self) -> float:
        """When it happened [s]."""
    @property
    def name(self) -> str:
        """One word."""
    @property
    def detail(self) -> str:
        """A sentence; may be empty."""

class FlownLoop:
    """The loop as it flies about a hover: with motor lag, sensors and estimator."""

    @property
    def stable(self) -> bool:
        """Whether every mode decays."""
    @property
    def grows(self) -> bool:
        """Whether a mode grows by more than a thousandth in ten seconds."""
    @property
    def largest_pole(self) -> float:
        """Largest |z| of a pole."""
    @property
    def decay(self) -> float:
        """Decay rate of that mode [1/s]."""
    @property
    def frequency(self) -> float:
        """Its frequency [rad/s]."""
    @property
    def mode(self) -> List[str]:
        """Its largest states."""
    @property
    def dt(self) -> float:
        """Control period [s]."""
    @property
    def period(self) -> int:
        """Control periods after which the sample times of the sensors repeat."""
    @property
    def estimator(self) -> str:
        """Name of the estimator."""
    @property
    def sensors(self) -> str:
        """"real" or "ideal"."""
    @property
    def margins(self) -> MarginsReport:
        """At the outputs of the law."""
    @property
    def drifts(self) -> List[str]:
        """States that no sensor observes."""
    @property
    def notes(self) -> List[str]:
        """What a reader should know."""

class FlownLqr:
    """State feedback with integrals, designed on the flown plant."""

    @property
    def gains(self) -> Gains:
        """The gains with their names."""
    @property
    def K(self) -> Array:
        """(nu, nx) of u = u0 + K (x_sp - x) + ..."""
    @property
    def K_int(self) -> Array:
        """(nu, ni) gain of the integrals."""
    @property
    def flown(self) -> FlownLoop:
        """The loop as it flies about a hover."""
    @property
    def ideal(self) -> MarginsReport:
        """Margins with true states, rotors without lag and no delays."""
    @property
    def messages(self) -> List[str]:
        """"note: ..." and "warning: ..."."""
    @property
    def riccati(self) -> Riccati:
        """The solution of the Riccati equation."""
    @property
    def met(self) -> bool:
        """Whether every channel has the margins that are asked for."""
    def to_json(self) -> str:
        """The text that `quadtune lqr V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune lqr V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune lqr V --json -o FILE` writes."""

class GainCrossover:
    """A frequency at which |L| = 1."""

    @property
    def w(self) -> float:
        """Frequency [rad/s]."""
    @property
    def phase_margin(self) -> float:
        """Phase margin there [rad]."""
    @property
    def delay_margin(self) -> float:
        """Delay margin there [s]."""

class GainMatch:
    """Diagonal LQR weights whose gain is closest to a given one."""

    @property
    def status(self) -> str:
        """"matched" or "not matched"."""
    @property
    def matched(self) -> bool:
        """Whether the weights give the gain within the tolerance."""
    @property
    def weights(self) -> List[MatchedWeight]:
        """MatchedWeight of states, integrals and inputs."""
    @property
    def unseen(self) -> List[str]:
        """Directions of the weights that the gain does not determine."""
    @property
    def states(self) -> List[str]:
        """Names of the states."""
    @property
    def integrals(self) -> List[str]:
        """Names of the integrated states."""
    @property
    def inputs(self) -> List[str]:
        """Names of the inputs."""
    @property
    def Q(self) -> Array:
        """(nx, nx) weights of the states."""
    @property
    def Q_integral(self) -> Array:
        """(ni, ni) weights of the integrals."""
    @property
    def R(self) -> Array:
        """(nu, nu) weights of the inputs."""
    @property
    def K(self) -> Array:
        """(nu, nx) gain of these weights."""
    @property
    def K_int(self) -> Array:
        """(nu, ni) gain of the integrals of these weights."""
    @property
    def K_given(self) -> Array:
        """(nu, nx) given gain, in the same order."""
    @property
    def K_int_given(self) -> Array:
        """(nu, ni) given gain of the integrals, in the same order."""
    @property
    def difference(self) -> Tuple[float, float]:
        """(before, after): largest difference of an entry, relative to the largest of its row
        or column."""
    @property
    def worst(self) -> str:
        """The entry with that difference, e.g. "K_int(w1, theta)"."""
    @property
    def tolerance(self) -> float:
        """On the difference."""
    @property
    def weighted_sensitivity(self) -> float:
        """At most 1 of every LQR gain with this R, with weights of the states of any kind."""
    @property
    def excess_cost(self) -> float:
        """Largest relative excess cost of the given gain; NaN if it is not known."""
    def save_design(self, file: Path) -> None:
        """Write a design file (TOML) with the weights, and with the given gain as the published
        one. Raises FileError if it cannot be written."""
    def to_json(self) -> str:
        """The text that `quadtune tune lqr V --match-gains FILE --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune tune lqr V --match-gains FILE --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune tune lqr V --match-gains FILE --json -o FILE` writes."""

class Gains:
    """u = u0 + K (x_sp - x) + K_int integral(x_sp - x), with what is needed to apply it."""

    @property
    def K(self) -> Array:
        """(nu, nx) of the states."""
    @property
    def K_int(self) -> Array:
        """(nu, ni) of the integrals."""
    @property
    def states(self) -> List[str]:
        """Names of states."""
    @property
    def inputs(self) -> List[str]:
        """Names of inputs."""
    @property
    def integrals(self) -> List[str]:
        """Names of integrated states."""
    @property
    def x0(self) -> Array:
        """Trim state (nx)."""
    @property
    def u0(self) -> Array:
        """Trim input (nu)."""
    @property
    def vehicle(self) -> str:
        """Name of the vehicle."""
    @property
    def convention(self) -> str:
        """Name of the convention."""
    @property
    def sign_law(self) -> str:
        """"set-point-minus-state" or "state-minus-set-point"."""
    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous law."""

class IdealLqr:
    """State feedback on the textbook plant of a vehicle."""

    @property
    def riccati(self) -> Riccati:
        """The solution of the Riccati equation."""
    @property
    def solved(self) -> bool:
        """Whether there is a solution; otherwise riccati.culprit names the mode."""
    @property
    def K(self) -> Array:
        """(nu, nx); NaN unless solved."""
    @property
    def K_int(self) -> Array:
        """(nu, ni); NaN unless solved."""
    @property
    def gains(self) -> Gains:
        """The gains with their names."""
    @property
    def poles(self) -> ComplexArray:
        """(n) of the loop as it is sampled."""
    @property
    def margins(self) -> MarginsReport:
        """At the inputs."""
    @property
    def flown(self) -> Optional[FlownLoop]:
        """FlownLoop, or None."""
    @property
    def model(self) -> Linearization:
        """The linear model."""
    @property
    def messages(self) -> List[str]:
        """"note: ..." and "warning: ..."."""
    def to_json(self) -> str:
        """The text that `quadtune lqr V --plant ideal --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune lqr V --plant ideal --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune lqr V --plant ideal --json -o FILE` writes."""

class InvalidInput(ValueError):
    """An argument or a file is wrong. `where` is the argument, or "file:line"; the message also states what was expected."""

    where: str

class Kalman:
    """A steady-state Kalman filter with its evidence."""

    @property
    def M(self) -> Array:
        """Filter gain (nx, ny); empty of a continuous filter."""
    @property
    def L(self) -> Array:
        """Predictor gain (nx, ny), or the gain of a continuous filter."""
    @property
    def P(self) -> Array:
        """Error covariance before the measurement (nx, nx)."""
    @property
    def Z(self) -> Array:
        """Error covariance after it; empty of a continuous filter."""
    @property
    def status(self) -> str:
        """"solved", "not detectable", ..."""
    @property
    def solved(self) -> bool:
        """Whether status is "solved"."""
    @property
    def poles(self) -> ComplexArray:
        """Eigenvalues of A - L C."""
    @property
    def residual(self) -> float:
        """Relative residual of the Riccati equation."""
    @property
    def rcond(self) -> float:
        """Reciprocal condition number of the equation."""
    @property
    def culprit(self) -> str:
        """The mode that prevents a solution; empty when solved."""
    @property
    def warning(self) -> str:
        """What is doubtful; empty for nothing."""
    @property
    def dt(self) -> float:
        """Sample period [s]; 1 of a discrete model, 0 of a continuous filter."""
    @property
    def sampled(self) -> Optional[SampledNoise]:
        """SampledNoise of a model with sampled, otherwise None."""
    def to_json(self) -> str:
        """The text that `quadtune kalman --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune kalman --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune kalman --json -o FILE` writes."""

class LimitCheck:
    """A limit of a mission held against a flight."""

    @property
    def metric(self) -> str:
        """Its name."""
    @property
    def value(self) -> float:
        """What was measured; NaN for nothing."""
    @property
    def bound(self) -> float:
        """The limit."""
    @property
    def ok(self) -> bool:
        """Whether the flight kept it."""

class Linearization:
    """x' = A (x - x0) + B (u - u0) about a steady flight, with names."""

    @property
    def trim(self) -> Trim:
        """The steady flight."""
    @property
    def A(self) -> Array:
        """(nx, nx) dynamics."""
    @property
    def B(self) -> Array:
        """(nx, nu) effect of the inputs."""
    @property
    def x0(self) -> Array:
        """(nx) state of the trim."""
    @property
    def x0_rate(self) -> Array:
        """(nx) its derivative in the trim."""
    @property
    def u0(self) -> Array:
        """(nu) input of the trim."""
    @property
    def states(self) -> List[str]:
        """Names of the states."""
    @property
    def state_units(self) -> List[str]:
        """Their units."""
    @property
    def inputs(self) -> List[str]:
        """Names of the inputs."""
    @property
    def input_units(self) -> List[str]:
        """Their units."""
    @property
    def convention(self) -> str:
        """Name of the convention."""
    @property
    def notes(self) -> List[str]:
        """What a reader should know."""
    def to_json(self) -> str:
        """The text that `quadtune linearize V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune linearize V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune linearize V --json -o FILE` writes."""

class Loop:
    """A loop under negative feedback with its margins."""

    @property
    def A(self) -> Array:
        """(nx, nx) of the open loop L with n channels, its delay left out."""
    @property
    def B(self) -> Array:
        """(nx, n) of the open loop."""
    @property
    def C(self) -> Array:
        """(n, nx) of the open loop."""
    @property
    def D(self) -> Array:
        """(n, n) of the open loop."""
    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous loop."""
    @property
    def delay(self) -> float:
        """Delay of a continuous loop [s]; a discrete loop has states for it."""
    @property
    def poles(self) -> ComplexArray:
        """(nx) of the closed loop, the delay left out."""
    @property
    def names(self) -> List[str]:
        """Names of the n channels."""
    @property
    def margins(self) -> MarginsReport:
        """Of the flown loop where there is one, otherwise of this loop."""
    @property
    def ideal(self) -> MarginsReport:
        """Margins of this loop."""
    @property
    def flown(self) -> Optional[FlownLoop]:
        """FlownLoop of a vehicle, or None."""
    @property
    def taken_as(self) -> str:
        """A doubt about what the matrices are; empty for none."""
    @property
    def skew(self) -> float:
        """Of the disk margins: 0 balances S and T, 1 is that of S, -1 that of T."""
    def bode(self, channel: Union[int, str] = 0) -> LoopCurves:
        """The frequency response of a channel, with all other channels closed.

        channel: a number from 0, or a name. Of a vehicle it is the ideal loop, as
        `quadtune margins --plot` draws it. Raises InvalidInput for an unknown channel."""
    def nyquist(self, channel: Union[int, str] = 0) -> LoopCurves:
        """The same as bode(): the values L are the Nyquist curve."""
    def step(self, channel: Union[int, str] = 0, duration: float = 0.0) -> Step:
        """The output of a channel after a unit step of its set point, all channels closed.

        channel: a number from 0, or a name. duration >= 0 [s]; 0 chooses one."""
    def response(self, w: npt.ArrayLike, channel: Union[int, str] = 0) -> ComplexArray:
        """L at the frequencies w (n) [rad/s], complex (n), with all other channels closed."""
    def to_json(self) -> str:
        """The text that `quadtune margins --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune margins --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune margins --json -o FILE` writes."""

class LoopCurves:
    """The frequency response of a loop: what Bode and Nyquist plots show."""

    @property
    def name(self) -> str:
        """Name of the channel."""
    @property
    def w(self) -> Array:
        """Frequencies [rad/s], increasing."""
    @property
    def L(self) -> ComplexArray:
        """L(jw), complex: the Nyquist curve."""
    @property
    def S(self) -> ComplexArray:
        """1/(1 + L), complex."""
    @property
    def magnitude_db(self) -> Array:
        """20 log10 |L|."""
    @property
    def phase_deg(self) -> Array:
        """Phase of L [deg], without jumps."""

class LoopMargins:
    """Margins of one loop."""

    @property
    def stable(self) -> bool:
        """Whether the closed loop is stable."""
    @property
    def gain_crossovers(self) -> List[GainCrossover]:
        """Of the loop, by frequency."""
    @property
    def phase_crossovers(self) -> List[PhaseCrossover]:
        """Of the loop, by frequency."""
    @property
    def gain_margin(self) -> float:
        """Smallest factor > 1 that brings L to -1; may be infinite."""
    @property
    def gain_reduction(self) -> float:
        """Largest factor < 1 that brings L to -1; 0 for none."""
    @property
    def phase_margin(self) -> float:
        """Smallest phase lag that makes the loop unstable [rad]; may be infinite."""
    @property
    def crossover(self) -> float:
        """Frequency of the phase margin [rad/s]."""
    @property
    def delay_margin(self) -> float:
        """Smallest delay that makes the loop unstable [s]; may be infinite."""
    @property
    def Ms(self) -> float:
        """Sensitivity peak max |1/(1 + L)|."""
    @property
    def w_Ms(self) -> float:
        """Its frequency [rad/s]."""
    @property
    def Mt(self) -> float:
        """Peak max |L/(1 + L)|."""
    @property
    def w_Mt(self) -> float:
        """Its frequency [rad/s]."""
    @property
    def disk(self) -> DiskMargin:
        """Disk margin of the loop."""

class Lqg:
    """State feedback together with its filter."""

    @property
    def gains(self) -> Gains:
        """The gains with their names."""
    @property
    def K(self) -> Array:
        """(nu, nx) of u = u0 + K (x_sp - x) + ..."""
    @property
    def K_int(self) -> Array:
        """(nu, ni) gain of the integrals."""
    @property
    def flown(self) -> FlownLoop:
        """The loop as it flies about a hover."""
    @property
    def ideal(self) -> MarginsReport:
        """Margins with true states, rotors without lag and no delays."""
    @property
    def messages(self) -> List[str]:
        """"note: ..." and "warning: ..."."""
    @property
    def at_estimates(self) -> MarginsReport:
        """Margins of the loop cut where the law reads its estimates."""
    @property
    def rms(self) -> PredictedRms:
        """Predicted deviations."""
    @property
    def recovery(self) -> float:
        """The factor on the noise of the filter that was chosen."""
    def to_json(self) -> str:
        """The text that `quadtune lqg V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune lqg V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune lqg V --json -o FILE` writes."""

class Lqr:
    """The LQR gain of matrices, with its evidence: u = -K x +
K_int integral(r - y) - K_past (u[k-1], u[k-2], ...)."""

    @property
    def riccati(self) -> Riccati:
        """The solution of the Riccati equation of all states: those of the plant, then the
        integrals, then past inputs."""
    @property
    def status(self) -> str:
        """"solved", "not stabilizable", "not detectable", ..."""
    @property
    def solved(self) -> bool:
        """Whether status is "solved"."""
    @property
    def K(self) -> Array:
        """(nu, nx); NaN unless solved."""
    @property
    def K_int(self) -> Array:
        """(nu, ny) gain of the integrals of r - y; empty without integrals."""
    @property
    def K_past(self) -> Array:
        """(nu, nu delay) gain of u[k-1], u[k-2], ...; empty without delay."""
    @property
    def S(self) -> Array:
        """Cost matrix of all states: x'Sx is the cost from x; NaN unless solved."""
    @property
    def poles(self) -> ComplexArray:
        """Of the closed loop of all states."""
    @property
    def margins(self) -> MarginsReport:
        """At the inputs u1, u2, ..."""
    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous loop."""
    @property
    def sampled(self) -> Optional[SampledCost]:
        """SampledCost of a problem with sampled, otherwise None."""
    @property
    def messages(self) -> List[str]:
        """"warning: ..." and "note: ..."."""
    def to_json(self) -> str:
        """The text that `quadtune lqr --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune lqr --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune lqr --json -o FILE` writes."""

class MarginsReport:
    """Margins of the channels of a loop."""

    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous loop."""
    @property
    def names(self) -> List[str]:
        """Names of the channels."""
    @property
    def loops(self) -> List[LoopMargins]:
        """LoopMargins of each channel."""
    @property
    def together(self) -> Optional[SimultaneousDiskMargin]:
        """Of all channels at once, or None."""
    @property
    def warnings(self) -> List[str]:
        """Channels with less than 6 dB, 30 degrees or one sample of delay."""
    @property
    def notes(self) -> List[str]:
        """Conventions that apply to these margins."""

class MatchedWeight:
    """A weight that was computed for a gain."""

    @property
    def name(self) -> str:
        """"Q(x)", "Q_integral(theta)", "R(w1)", ..."""
    @property
    def before(self) -> float:
        """At the start of the first search."""
    @property
    def value(self) -> float:
        """The result."""
    @property
    def low(self) -> float:
        """Lower end of the interval; 0 if not determined."""
    @property
    def high(self) -> float:
        """Upper end of the interval; infinite if not determined."""
    @property
    def verdict(self) -> str:
        """How well the gain determines it: empty, "poorly determined", "in
        combination", "not determined", "at zero" or "fixed"."""

class MatrixLqg:
    """LQR and Kalman filter of matrices as one controller."""

    @property
    def solved(self) -> bool:
        """Whether both equations are solved."""
    @property
    def culprit(self) -> str:
        """The equation and the mode that prevents a solution; empty when solved."""
    @property
    def riccati(self) -> Riccati:
        """The solution of the Riccati equation of the LQR."""
    @property
    def K(self) -> Array:
        """(nu, nx) gain of u = -K x; NaN unless solved."""
    @property
    def S(self) -> Array:
        """(nx, nx) cost matrix of the LQR; NaN unless solved."""
    @property
    def L(self) -> Array:
        """(nx, ny) predictor gain, or the gain of a continuous filter; NaN unless solved."""
    @property
    def M(self) -> Array:
        """(nx, ny) filter gain; empty of a continuous filter."""
    @property
    def P(self) -> Array:
        """(nx, nx) error covariance before the measurement; NaN unless solved."""
    @property
    def controller(self) -> Controller:
        """Controller from y to -u, whose states are the estimates; empty unless solved."""
    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous controller."""
    @property
    def poles(self) -> ComplexArray:
        """(2 nx) of the closed loop; empty unless solved."""
    @property
    def cost(self) -> float:
        """Mean cost, per step if discrete; NaN unless solved."""
    @property
    def state_rms(self) -> Array:
        """(nx) standard deviations in the closed loop; empty unless solved."""
    @property
    def input_rms(self) -> Array:
        """(nu) standard deviations of u; empty unless solved."""
    @property
    def margins(self) -> MarginsReport:
        """At the inputs u1, u2, ..."""
    @property
    def messages(self) -> List[str]:
        """"warning: ..." and "note: ..."."""
    def to_json(self) -> str:
        """The text that `quadtune lqg --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune lqg --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune lqg --json -o FILE` writes."""

class MatrixLqr:
    """Gains for programs that hold matrices alone, designed on the flown plants."""

    @property
    def gains(self) -> Gains:
        """The gains with their names."""
    @property
    def K(self) -> Array:
        """(nu, nx) of u = u0 + K (x_sp - x) + ..."""
    @property
    def K_int(self) -> Array:
        """(nu, ni) gain of the integrals."""
    @property
    def flown(self) -> FlownLoop:
        """The loop as it flies about a hover."""
    @property
    def ideal(self) -> MarginsReport:
        """Margins with true states, rotors without lag and no delays."""
    @property
    def messages(self) -> List[str]:
        """"note: ..." and "warning: ..."."""
    def to_json(self) -> str:
        """The text that `quadtune lqr V --structure matrix --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune lqr V --structure matrix --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune lqr V --structure matrix --json -o FILE` writes."""

class MeasuredLoop:
    """A loop that is known by its frequency response, with its margins."""

    @property
    def margins(self) -> MarginsReport:
        """Of the one loop; a margin that the data leave open is infinite."""
    @property
    def samples(self) -> int:
        """Number of frequencies."""
    @property
    def w_min(self) -> float:
        """Lowest frequency [rad/s]."""
    @property
    def w_max(self) -> float:
        """Highest frequency [rad/s]."""
    @property
    def crosses_gain(self) -> bool:
        """Whether |L| passes 1 within the data."""
    @property
    def crosses_phase(self) -> bool:
        """Whether L passes the negative real axis within the data."""
    @property
    def largest_phase_step(self) -> float:
        """Between neighbours [rad]; above pi/2 the data are too coarse."""
    @property
    def notes(self) -> List[str]:
        """What is assumed, and what the data leave open."""
    def to_json(self) -> str:
        """The text that `quadtune margins --frd FILE --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune margins --frd FILE --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune margins --frd FILE --json -o FILE` writes."""

class MethodComparison:
    """What each sampling method makes of a vehicle's loops."""

    @property
    def vehicle(self) -> str:
        """Name of the vehicle."""
    @property
    def dt(self) -> float:
        """Sample period [s]."""
    @property
    def periods(self) -> List[float[3]]:
        """dt/2, dt and 2 dt [s]."""
    def to_json(self) -> str:
        """The text that `quadtune discretize V --compare --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune discretize V --compare --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune discretize V --compare --json -o FILE` writes."""

class NoSolution(ArithmeticError):
    """A problem of several steps has no solution, for example a vehicle that cannot hover. The message names the cause, `where` the argument, file or vehicle."""

    where: str

class PhaseCrossover:
    """A frequency at which L is real and negative."""

    @property
    def w(self) -> float:
        """Frequency [rad/s]."""
    @property
    def gain_margin(self) -> float:
        """Factor that brings L to -1."""

class Pid:
    """PID gains for a transfer function."""

    @property
    def Kp(self) -> float:
        """Proportional gain."""
    @property
    def Ki(self) -> float:
        """Integral gain [1/s]."""
    @property
    def Kd(self) -> float:
        """Derivative gain [s]."""
    @property
    def Tf(self) -> float:
        """Time constant of the filter of the derivative [s]; 0 for none."""
    @property
    def num(self) -> Optional[Array]:
        """Of the discrete controller, descending powers of z; None without dt."""
    @property
    def den(self) -> Optional[Array]:
        """Of the discrete controller, descending powers of z; None without dt."""
    @property
    def dt(self) -> float:
        """Sample period of the discrete controller [s]; 0 without one."""
    @property
    def controller(self) -> Controller:
        """The same as a Controller, for margins()."""
    def to_json(self) -> str:
        """The text that `quadtune pid --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune pid --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune pid --json -o FILE` writes."""
    @property
    def type(self) -> str:
        """"P", "PI", "PD" or "PID"."""
    @property
    def how(self) -> str:
        """How the gains were computed, in words."""
    @property
    def margins(self) -> MarginsReport:
        """Of the continuous loop."""

class PidAlone:
    """PID gains without a plant."""

    @property
    def Kp(self) -> float:
        """Proportional gain."""
    @property
    def Ki(self) -> float:
        """Integral gain [1/s]."""
    @property
    def Kd(self) -> float:
        """Derivative gain [s]."""
    @property
    def Tf(self) -> float:
        """Time constant of the filter of the derivative [s]; 0 for none."""
    @property
    def num(self) -> Optional[Array]:
        """Of the discrete controller, descending powers of z; None without dt."""
    @property
    def den(self) -> Optional[Array]:
        """Of the discrete controller, descending powers of z; None without dt."""
    @property
    def dt(self) -> float:
        """Sample period of the discrete controller [s]; 0 without one."""
    @property
    def controller(self) -> Controller:
        """The same as a Controller, for margins()."""
    def to_json(self) -> str:
        """The text that `quadtune pid --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune pid --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune pid --json -o FILE` writes."""
    @property
    def how(self) -> str:
        """How the gains were computed, in words."""

class PidLoop:
    """output = Kp error + Ki integral(error) + Kd (rate + rate_lead rate')"""

    @property
    def name(self) -> str:
        """"x", "y", "pitch", "roll", "yaw", ..."""
    @property
    def output(self) -> str:
        """What the loop commands."""
    @property
    def unit(self) -> str:
        """Of the output per unit of the error."""
    @property
    def Kp(self) -> float:
        """Proportional gain."""
    @property
    def Ki(self) -> float:
        """Integral gain."""
    @property
    def Kd(self) -> float:
        """Derivative gain, with its own sign."""
    @property
    def rate_lead(self) -> float:
        """Lead time of the rate [s]; 0: none."""
    @property
    def rate_filter(self) -> float:
        """Time constant of the low pass of the rate's derivative [s]."""

class PolePlacement:
    """The gain of u = -K x with given poles, with its evidence."""

    @property
    def status(self) -> str:
        """"solved", "not controllable" or "inaccurate"."""
    @property
    def solved(self) -> bool:
        """Whether status is "solved"."""
    @property
    def K(self) -> Array:
        """(nu, nx); NaN unless solved."""
    @property
    def poles(self) -> ComplexArray:
        """(nx) computed eigenvalues of A - B K; empty unless solved."""
    @property
    def error(self) -> float:
        """Largest distance between a requested pole and the computed one; NaN unless computed."""
    @property
    def culprit(self) -> str:
        """The mode that cannot be moved; empty when solved."""
    def to_json(self) -> str:
        """The text that `quadtune place --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune place --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune place --json -o FILE` writes."""

class PredictedRms:
    """Standard deviations that the noise of the sensors causes in calm air."""

    @property
    def time(self) -> float:
        """Since the vehicle was at rest [s]."""
    @property
    def state(self) -> Array:
        """(12) of the true states, in SI units."""
    @property
    def error(self) -> Array:
        """(12) of the errors of the estimates, in SI units."""
    @property
    def command(self) -> Array:
        """(nu) of the commands, in SI units."""
    @property
    def turned(self) -> Array:
        """(12) the part by which the heading turns; contained in state."""

class Riccati:
    """The solution of an algebraic Riccati equation with its evidence, or the reason why there is none."""

    @property
    def status(self) -> str:
        """"solved", "not stabilizable", "not detectable", ..."""
    @property
    def solved(self) -> bool:
        """Whether status is "solved"."""
    @property
    def X(self) -> Array:
        """The solution (nx, nx); NaN unless solved."""
    @property
    def K(self) -> Array:
        """The gain of u = -K x (nu, nx); NaN unless solved."""
    @property
    def poles(self) -> ComplexArray:
        """(nx) eigenvalues of A - B K; empty unless solved."""
    @property
    def residual(self) -> float:
        """Relative residual of the equation."""
    @property
    def rcond(self) -> float:
        """Reciprocal condition number of the equation."""
    @property
    def iterations(self) -> int:
        """Doubling steps."""
    @property
    def culprit(self) -> str:
        """The mode that prevents a solution; empty when solved."""
    @property
    def warning(self) -> str:
        """What is doubtful; empty for nothing."""

class Rotor:
    """Motor and propeller."""

    @property
    def position(self) -> Array:
        """Hub from the centre of mass, body axes [m]."""
    @property
    def spin(self) -> str:
        """"cw" or "ccw"."""
    @property
    def thrust_a2(self) -> float:
        """Thrust per squared speed [N s2/rad2]."""
    @property
    def thrust_a1(self) -> float:
        """Thrust per speed [N s/rad]."""
    @property
    def torque_d2(self) -> float:
        """Drag torque per squared speed [N m s2/rad2]."""
    @property
    def torque_d1(self) -> float:
        """Drag torque per speed [N m s/rad]."""
    @property
    def inertia(self) -> float:
        """Of the turning parts [kg m2]."""
    @property
    def lag(self) -> float:
        """Time constant of the speed [s]."""

class SampledCost:
    """A continuous LQR problem whose input is held, per step."""

    @property
    def A(self) -> Array:
        """(nx, nx) of the sampled plant."""
    @property
    def B(self) -> Array:
        """(nx, nu) of the sampled plant."""
    @property
    def Q(self) -> Array:
        """(nx, nx) weights of the states per step."""
    @property
    def R(self) -> Array:
        """(nu, nu) weights of the inputs per step."""
    @property
    def N(self) -> Array:
        """(nx, nu) cross weights per step."""

class SampledNoise:
    """A continuous model with noise that is measured at samples, per step."""

    @property
    def A(self) -> Array:
        """(nx, nx) of the sampled model."""
    @property
    def Q(self) -> Array:
        """(nx, nx) covariance of the process noise per step."""
    @property
    def R(self) -> Array:
        """(ny, ny) covariance of a measurement."""

class SampledPlant:
    """A plant that was sampled, or taken back to continuous time."""

    @property
    def A(self) -> Optional[Array]:
        """(nx, nx); None of a transfer function."""
    @property
    def B(self) -> Optional[Array]:
        """(nx, nu); None of a transfer function."""
    @property
    def C(self) -> Optional[Array]:
        """(ny, nx); None of a transfer function."""
    @property
    def D(self) -> Optional[Array]:
        """(ny, nu); None of a transfer function."""
    @property
    def num(self) -> Optional[Array]:
        """Descending powers; None of matrices."""
    @property
    def den(self) -> Optional[Array]:
        """Descending powers; None of matrices."""
    @property
    def delay(self) -> Optional[float]:
        """Of a transfer function: whole samples of a discrete one, seconds of a continuous one."""
    @property
    def dt(self) -> float:
        """Sample period [s]."""
    @property
    def method(self) -> str:
        """"zoh", "tustin", ..."""
    @property
    def warnings(self) -> List[str]:
        """For example of a period that is too long."""
    def to_json(self) -> str:
        """The text that `quadtune discretize --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune discretize --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune discretize --json -o FILE` writes."""

class Schedule:
    """State-feedback gains over a grid of flights."""

    @property
    def axes(self) -> dict:
        """Values of each axis, by quantity, in their order; the last varies fastest."""
    @property
    def status(self) -> List[str]:
        """"solved", "no trim" or "no gain" of each point; the last axis varies fastest."""
    @property
    def culprits(self) -> List[str]:
        """Why a point has no gain; empty if it has one. In the order of status."""
    @property
    def states(self) -> List[str]:
        """Names of the states."""
    @property
    def inputs(self) -> List[str]:
        """Names of the inputs."""
    @property
    def integrals(self) -> List[str]:
        """Names of the integrated states."""
    @property
    def vehicle(self) -> str:
        """Name of the vehicle."""
    @property
    def convention(self) -> str:
        """Name of the convention."""
    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous law."""
    @property
    def yaw(self) -> float:
        """Heading of all points [rad]."""
    @property
    def messages(self) -> List[str]:
        """"warning: ..." and "note: ..."."""
    @property
    def K(self) -> Array:
        """(axis 1, axis 2, ..., nu, nx); NaN where there is no gain."""
    @property
    def K_int(self) -> Array:
        """(axis 1, axis 2, ..., nu, ni); NaN where there is no gain."""
    @property
    def x0(self) -> Array:
        """(axis 1, axis 2, ..., nx) trim states; NaN where there is no gain."""
    @property
    def u0(self) -> Array:
        """(axis 1, axis 2, ..., nu) trim inputs; NaN where there is no gain."""
    def at(self, values: Numbers) -> ScheduledGain:
        """Gains by multilinear interpolation; nothing is extrapolated.

        values: one of each axis, in their order. Outside the grid, and next to a point
        without a gain, the result is not found. Raises InvalidInput for another count of
        values."""
    def to_json(self) -> str:
        """The table that `quadtune lqr V --schedule GRID --json` prints."""
    def to_dict(self) -> dict:
        """The same as Python objects."""
    def save(self, file: Path) -> None:
        """Write the table as TOML or JSON, by the end of the name, for fly() and export().

        Raises InvalidInput for another name, FileError if it cannot be written."""

class ScheduledGain:
    """Gains between the points of a grid, or the reason for none."""

    @property
    def found(self) -> bool:
        """Whether there are gains."""
    @property
    def K(self) -> Array:
        """(nu, nx); empty unless found."""
    @property
    def K_int(self) -> Array:
        """(nu, ni); empty unless found."""
    @property
    def x0(self) -> Array:
        """(nx) trim state; empty unless found."""
    @property
    def u0(self) -> Array:
        """(nu) trim input; empty unless found."""
    @property
    def culprit(self) -> str:
        """The axis and its range, or the point without gain; empty if found."""

class SimultaneousDiskMargin:
    """The disk in which the factors of all loops may be at once."""

    @property
    def guaranteed(self) -> DiskMargin:
        """The largest disk for which stability is proved."""
    @property
    def alpha_destabilizing(self) -> float:
        """Size of a disk with factors that destabilize."""

class Step:
    """The answer of a closed loop to a step."""

    @property
    def t(self) -> Array:
        """Times [s]."""
    @property
    def y(self) -> Array:
        """Output per unit of the set point."""

class System:
    """Poles, zeros and norms of a linear system."""

    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous system."""
    @property
    def stable(self) -> bool:
        """Whether every pole is stable."""
    @property
    def poles(self) -> ComplexArray:
        """(nx) eigenvalues of A."""
    @property
    def zeros(self) -> ComplexArray:
        """Finite invariant zeros; may be none."""
    @property
    def rank(self) -> int:
        """Rank of the transfer function matrix."""
    @property
    def dc_gain(self) -> Optional[Array]:
        """(ny, nu) response to constant inputs; None with a pole there."""
    @property
    def peak_gain(self) -> float:
        """Largest singular value over all frequencies; infinite with a pole on the boundary."""
    @property
    def hinf_norm(self) -> Optional[float]:
        """H-infinity norm: peak_gain of a stable system, otherwise None."""
    @property
    def hinf_frequency(self) -> float:
        """Frequency of the peak [rad/s]; infinite where the feed-through attains it."""
    @property
    def h2_norm(self) -> float:
        """H2 norm; infinite if unstable, or if continuous with D other than 0."""
    def to_json(self) -> str:
        """The text that `quadtune analyze --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune analyze --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune analyze --json -o FILE` writes."""

class Trim:
    """A steady flight, or the reason why there is none."""

    @property
    def status(self) -> str:
        """"solved", "not enough thrust", ..."""
    @property
    def solved(self) -> bool:
        """Whether status is "solved"."""
    @property
    def x(self) -> Array:
        """(12) state in the words of ned; NaN unless solved."""
    @property
    def u(self) -> Array:
        """Rotor speeds [rad/s]; NaN unless solved."""
    @property
    def thrust(self) -> Array:
        """Rotor thrusts [N]; NaN unless solved."""
    @property
    def residual(self) -> float:
        """Relative acceleration that remains."""
    @property
    def tilt(self) -> float:
        """From the vertical [rad]."""
    @property
    def thrust_to_weight(self) -> float:
        """Of all rotors at most."""
    @property
    def culprit(self) -> str:
        """What is missing; empty when solved."""

class TunedKalman:
    """Noise covariances of a filter from logs, with a verdict."""

    @property
    def status(self) -> str:
        """"converged", "not computed", ..."""
    @property
    def culprit(self) -> str:
        """Why there is no fit; empty if there is."""
    @property
    def passed(self) -> bool:
        """Whether the covariances can be believed."""
    @property
    def reasons(self) -> List[str]:
        """Of a verdict that is not pass."""
    @property
    def parameters(self) -> List[FittedParameter]:
        """FittedParameter of each."""
    @property
    def log_likelihood(self) -> Tuple[float, float]:
        """(before, after)."""
    @property
    def warnings(self) -> List[str]:
        """What a user should know whatever the verdict."""
    def save_model(self, file: Path) -> None:
        """Write the tuned filter model, which states its verdict."""
    def to_json(self) -> str:
        """The text that `quadtune tune kalman --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune tune kalman --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune tune kalman --json -o FILE` writes."""

class TunedLqr:
    """LQR weights that were searched over missions."""

    @property
    def accepted(self) -> bool:
        """Whether fresh draws prove that the candidate is better than the start."""
    @property
    def reason(self) -> str:
        """Why, in words."""
    @property
    def costs(self) -> Array:
        """Cost of each point, in the order in which they were tried; NaN of an unstable one."""
    @property
    def evaluations(self) -> int:
        """Number of points that were tried."""
    def save_design(self, file: Path) -> None:
        """Write the candidate as a design file (TOML), which states the reason.

        Raises FileError if it cannot be written."""
    @property
    def weights(self) -> TunedWeights:
        """TunedWeights that count: those of the start where nothing better was accepted."""
    @property
    def start(self) -> TunedWeights:
        """TunedWeights of the start."""
    @property
    def candidate(self) -> TunedWeights:
        """TunedWeights of the best point of the search, accepted or not."""
    def to_json(self) -> str:
        """The text that `quadtune tune lqr V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune tune lqr V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune tune lqr V --json -o FILE` writes."""

class TunedPid:
    """PID gains that were searched over missions."""

    @property
    def accepted(self) -> bool:
        """Whether fresh draws prove that the candidate is better than the start."""
    @property
    def reason(self) -> str:
        """Why, in words."""
    @property
    def costs(self) -> Array:
        """Cost of each point, in the order in which they were tried; NaN of an unstable one."""
    @property
    def evaluations(self) -> int:
        """Number of points that were tried."""
    def save_design(self, file: Path) -> None:
        """Write the candidate as a design file (TOML), which states the reason.

        Raises FileError if it cannot be written."""
    @property
    def loops(self) -> List[PidLoop]:
        """PidLoop of the gains that count: the start where nothing better was accepted."""
    @property
    def start(self) -> List[PidLoop]:
        """PidLoop of the start."""
    @property
    def candidate(self) -> List[PidLoop]:
        """PidLoop of the best point of the search, accepted or not."""
    def to_json(self) -> str:
        """The text that `quadtune tune pid V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune tune pid V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune tune pid V --json -o FILE` writes."""

class TunedWeights:
    """Diagonal weights of an LQR with their gains."""

    @property
    def names(self) -> List[str]:
        """Of states, integrals and inputs."""
    @property
    def weights(self) -> Array:
        """In the order of names."""
    @property
    def gains(self) -> Optional[Gains]:
        """Gains, or None without a solution."""

class Vehicle:
    """The numbers of one multirotor, in SI units."""

    @property
    def name(self) -> str:
        """Name."""
    @property
    def description(self) -> str:
        """One sentence."""
    @property
    def source(self) -> str:
        """Where the numbers come from."""
    @property
    def mass(self) -> float:
        """Mass [kg]."""
    @property
    def inertia(self) -> Array:
        """(3, 3) about the centre of mass [kg m2]."""
    @property
    def rotors(self) -> List[Rotor]:
        """The rotors, numbered from 1 in messages."""
    @property
    def gravity(self) -> float:
        """Acceleration of gravity [m/s2]."""
    @property
    def air_density(self) -> float:
        """At which the rotor curves hold [kg/m3]."""
    @property
    def file(self) -> str:
        """It was read from."""
    def to_json(self) -> str:
        """The text that `quadtune vehicle show V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune vehicle show V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune vehicle show V --json -o FILE` writes."""

class VehicleCheck:
    """A vehicle that can hover."""

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle."""
    @property
    def hover(self) -> Trim:
        """Its hover."""
    @property
    def warnings(self) -> List[str]:
        """Figures outside their plausible ranges."""

class Verification:
    """An export, read back and checked."""

    @property
    def ok(self) -> bool:
        """Whether every check is."""
    @property
    def checks(self) -> List[VerifyCheck]:
        """VerifyCheck of each question."""
    @property
    def gains(self) -> Optional[Gains]:
        """As read from the files, or None."""
    @property
    def poles(self) -> ComplexArray:
        """(n) of the closed loop of these gains."""
    def to_json(self) -> str:
        """The text that `quadtune verify DIR --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune verify DIR --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune verify DIR --json -o FILE` writes."""

class VerifyCheck:
    """One question about an export, and its answer."""

    @property
    def name(self) -> str:
        """The question."""
    @property
    def ok(self) -> bool:
        """The answer."""
    @property
    def detail(self) -> str:
        """What was found."""

@overload
def analyze(A: npt.ArrayLike, B: npt.ArrayLike, C: Optional[npt.ArrayLike] = None, D: Optional[npt.ArrayLike] = None, *, dt: Optional[float] = None) -> System:
    """Poles, zeros, gain at rest, H-infinity and H2 norm of matrices.

    A (nx, nx), B (nx, nu), C (ny, nx) or None for the states, D (ny, nu) or None for zero.
    dt > 0: the sample period [s] of a discrete system. Raises InvalidInput for wrong
    shapes and entries that are not finite."""
@overload
def analyze(*, num: Numbers, den: Numbers, dt: Optional[float] = None) -> System:
    """The same of a transfer function.

    num, den: coefficients in descending powers of s, or of z with dt > 0 [s], with at most
    as many zeros as poles. Raises InvalidInput for other coefficients."""

def campaign(file: Path, folder: Optional[Path] = None, *, shards: int = 0, threads: int = 0, seed: Optional[int] = None) -> Campaign:
    """Plan, fly and merge a campaign on this machine.

    file: a campaign file (docs/formats.md). folder: a new one, or one where this was
    stopped, which continues there; default: the file's name with -campaign, in the current
    folder. shards: parts into which the flights are divided; 0 chooses. threads: 0 for one
    of each processor. seed: replaces that of the file. Ctrl-C ends it; what was flown stays.
    Raises InvalidInput with "file:line" for a wrong file, NoSolution if a design of it has
    none, FileError if files cannot be read or written."""

def certify(directory: Path, *, vehicle: Optional[VehicleLike] = None, controller: str = '', mass: Optional[Tuple[float, float]] = None, inertia: Optional[Tuple[float, float]] = None, thrust: Optional[Tuple[float, float]] = None, delay: Optional[Tuple[float, float]] = None, lag: Optional[Tuple[float, float]] = None, integrator: Optional[str] = None, plant: str = 'flown', budget: int = 20000, seed: int = 1, threads: int = 0) -> Certificate:
    """Prove the loops of an export stable for every vehicle of a box, or find one that is
    not.

    directory: of an export. vehicle: where the manifest's is not built in. controller:
    "state-feedback" or "cascaded-pid", where both were exported. mass, inertia,
    thrust: (low, high) > 0, ratios to the vehicle's file; default: those of its [spread], or
    0.9 to 1.1, 0.8 to 1.2 and 0.9 to 1.1. delay >= 0 of the loop and lag
    >= 0 of the motors: (low, high) [s]; default: up to one period, and that of the
    vehicle. integrator of a cascade: "euler", "backward-euler" or "tustin". plant:
    "flown" or "ideal". budget: boxes that a proof may inspect. threads: 0 for one of
    each processor. Raises InvalidInput for a wrong argument or export, FileError if files
    cannot be read."""

def check_vehicle(vehicle: VehicleLike) -> VehicleCheck:
    """Check that a vehicle can hover and that its rotors command thrust and all torques.

    vehicle: a built-in name, a file or a Vehicle. Raises NoSolution with the cause if it
    cannot, InvalidInput with "file:line" for a wrong file, FileError if it cannot be
    read."""

def compare_methods(vehicle: VehicleLike, dt: float, *, plant: str = 'flown') -> MethodComparison:
    """Compare every sampling method on the LQR and PID loops of a vehicle.

    dt > 0 [s]: the methods are compared at dt/2, dt and 2 dt. plant: "flown" or
    "ideal". Raises InvalidInput for a wrong argument, NoSolution if the vehicle has no
    loops to compare, FileError if its file cannot be read."""

def design(file: Path, *, directory: Optional[Path] = None, force: bool = False, seeds: Optional[int] = None, seed: int = 1, to: Optional[Names] = None) -> Design:
    """Trim, linearize, compute gains, fly missions, export and verify, as a design
    file says, or for the usual cascade of a vehicle.

    file: a design file, a vehicle file or a built-in vehicle. to: for a vehicle, the
    names of the exports, by default json and c; the gains are designed for a
    firmware among them.
    directory: where exports and pages are written if the design passes; with force
    whatever the outcome. seeds >= 1: flights of each mission, by default 5; seed:
    of the first. A design that fails is a result with passed == False and its
    failure. Raises InvalidInput with "file:line" for a wrong file, NoSolution if
    a problem of it has none, FileError if files cannot be read or written."""

@overload
def discretize(A: npt.ArrayLike, B: npt.ArrayLike, C: Optional[npt.ArrayLike] = None, D: Optional[npt.ArrayLike] = None, *, dt: float, method: str = 'zoh', prewarp: Optional[float] = None, input_delay: Optional[Numbers] = None, output_delay: Optional[Numbers] = None, inverse: bool = False) -> SampledPlant:
    """Sample a continuous system of matrices, or with inverse=True take a discrete one back.

    A (nx, nx), B (nx, nu), C (ny, nx) or None for the states, D (ny, nu) or None for zero.
    dt > 0: sample period [s]. method: "zoh", "foh", "impulse", "euler",
    "backward-euler", "tustin" or "matched". prewarp > 0: frequency at which tustin
    is exact [rad/s]. input_delay, output_delay >= 0 [s]: of all channels, or of each (nu),
    (ny). Raises InvalidInput for wrong shapes, entries that are not finite, numbers out of
    range, and a method that cannot be taken back."""
@overload
def discretize(*, num: Numbers, den: Numbers, dt: float, delay: float = 0.0, method: str = 'zoh', prewarp: Optional[float] = None, inverse: bool = False) -> SampledPlant:
    """The same of a transfer function.

    num, den: coefficients in descending powers of s, or with inverse=True of z.
    delay >= 0 [s]. The other arguments, and the exceptions, as for matrices."""

def export(source: Path, to: str, directory: Path, *, vehicle: Optional[VehicleLike] = None, name: str = '', precision: str = '', law: str = '', adapter: str = '', imu_calibration: Optional[Path] = None, constants: bool = False, firmware: str = '', setup: str = '', filter_noise: bool = False, force: bool = False) -> Export:
    """Write gains, or what a design gives, for another program.

    source: an export, a gain file, a design file, a vehicle or, with to="c", a gain
    schedule. to: "uquad", "mambo", "json", "mat", "c", "px4", "ardupilot",
    "betaflight" or "crazyflie". directory: where the files are written. vehicle: where
    the source does not name one. With to="c": name of the functions, precision
    "float" or "double", law and adapter. With to="uquad": imu_calibration, a file,
    and constants. With an autopilot: firmware, its version, setup and filter_noise. force:
    also a design that does not pass. docs/cli.md explains them, as options of `quadtune
    export`. Raises InvalidInput for a wrong argument or source, and for gains that do not
    hold the vehicle; NoSolution if a design has none; FileError."""

def fly(vehicle: VehicleLike, *, mission: Path = 'hover', controller: str = '', gains: Path = '', integrator: str = '', estimator: str = '', flow: str = '', flow_rate: Optional[float] = None, sensors: str = '', wind: str = 'calm', allocation: str = '', take_off: str = '', duration: Optional[float] = None, solver: str = 'bogacki-shampine-3', step: Optional[float] = None, dynamic_environment: bool = False, seed: int = 1, seeds: Optional[int] = None, log: bool = True, diagnose: bool = True) -> Union[Flight, List[Flight]]:
    """Fly a mission in the nonlinear simulation, with a verdict.

    mission: a built-in name or a file. controller: "cascaded-pid", "state-feedback" or
    "firmware". gains: "designed", "published", an export, a gain or design file, or
    what a result's save() wrote. duration > 0 [s]: default: that of the mission. step > 0:
    of the solver [s]. flow_rate > 0: of the optical flow [Hz]. The other words are those
    of `quadtune fly` (docs/cli.md#flights). seeds=N >= 1 flies N seeds from `seed` on and
    returns a list. log=False keeps no record; diagnose=False does not look for the cause
    of a failure. A flight that fails is a result with passed == False. Raises InvalidInput
    for unknown words and numbers out of range, NoSolution if the vehicle cannot hover or a
    design has no solution, FileError if a file cannot be read."""

def kalman(A: npt.ArrayLike, C: npt.ArrayLike, Q: npt.ArrayLike, R: npt.ArrayLike, *, G: Optional[npt.ArrayLike] = None, N: Optional[npt.ArrayLike] = None, discrete: bool = False, sampled: Optional[float] = None) -> Kalman:
    """The steady-state Kalman filter of matrices.

    A (nx, nx), C (ny, nx), Q (nw, nw) symmetric and >= 0, R (ny, ny) symmetric and > 0, G
    (nx, nw) or None for the identity, N (nw, ny) or None for zero: x' = A x + G w, y = C x
    + v. Continuous by default, Q and R are spectral densities; discrete=True: they are
    covariances per step; sampled > 0 [s]: the continuous model is measured every so many
    seconds. A problem without solution is a result whose status is not "solved" and
    whose culprit names the mode. Raises InvalidInput for wrong shapes, entries that are
    not finite and covariances out of range."""

def linearize(vehicle: VehicleLike, *, at: str = 'hover', speed: float = 0.0, climb: float = 0.0, radius: float = 0.0, yaw_rate: float = 0.0, yaw: float = 0.0, convention: str = 'ned', inputs: str = 'rotor-speed', states: Names = 'full') -> Linearization:
    """Trim a vehicle and compute its linear model.

    at: "hover", "line", "circle" or "spin". speed >= 0 of line and circle [m/s],
    climb of line, circle and spin, upward [m/s], radius of the circle, not 0 [m], yaw_rate
    of the spin, not 0 [rad/s], yaw: heading from north, clockwise from above [rad]; a
    negative radius or yaw_rate turns to the left. convention: "ned", "uquad",
    "mambo" or a file. inputs: "rotor-speed", "rotor-thrust", "wrench" or
    "command". states: "full", "no-position" or names. Raises NoSolution if there is
    no such trim, InvalidInput for a wrong argument, FileError if a file cannot be read."""

def load_campaign(folder: Path, *, threads: int = 0) -> Campaign:
    """Merge the flown shards of a campaign, as `quadtune campaign merge` does.

    folder: where the campaign was planned. threads: 0 for one of each processor. Raises
    InvalidInput if shards are missing or do not belong together, FileError if files cannot
    be read or written."""

def load_schedule(file: Path) -> Schedule:
    """Read a schedule that was saved: a table in TOML or JSON.

    Raises FileError if it cannot be read, InvalidInput with "file:line" if it is wrong."""

@overload
def lqg(A: npt.ArrayLike, B: npt.ArrayLike, C: npt.ArrayLike, Q: npt.ArrayLike, R: npt.ArrayLike, noise_Q: npt.ArrayLike, noise_R: npt.ArrayLike, *, D: Optional[npt.ArrayLike] = None, N: Optional[npt.ArrayLike] = None, G: Optional[npt.ArrayLike] = None, noise_N: Optional[npt.ArrayLike] = None, discrete: bool = False, sampled: Optional[float] = None, dt: Optional[float] = None, estimate: Optional[str] = None) -> MatrixLqg:
    """LQR and Kalman filter of matrices as one controller.

    A (nx, nx), B (nx, nu), C (ny, nx), D (ny, nu) or None for zero. Weights Q (nx, nx) >=
    0, R (nu, nu) > 0 and N (nx, nu) as lqr(); noise_Q (nw, nw) >= 0, noise_R (ny, ny) > 0,
    noise_N (nw, ny) and G (nx, nw) as Q, R, N and G of kalman(). Continuous by default;
    discrete=True for a sampled plant, dt > 0 [s] (1 by default) its period; sampled > 0
    [s] for a continuous problem whose input is held for so long. estimate, unless
    continuous: "current" (default), the command uses the measurement of its sample, or
    "delayed", it does not. A problem without solution is a result with solved == False
    and its culprit. Raises InvalidInput for wrong shapes, entries that are not finite, and
    weights and covariances out of range."""
@overload
def lqg(vehicle: VehicleLike, *, Q: Optional[Numbers] = None, R: Optional[Numbers] = None, integral: Optional[Names] = None, dt: Optional[float] = None, change: Optional[Numbers] = None, past: Optional[int] = None, estimator: str = '', sensors: str = '', height: float = 1.1, time: float = 60.0, recover: bool = False, noise_budget: Optional[float] = None) -> Lqg:
    """State feedback and filter of a vehicle together: predicted deviations and margins.

    Arguments and exceptions as lqr() on the flown plant. time > 0 and at most 1e6: of the
    prediction [s]. recover: raise the noise that the filter assumes where that gives larger
    margins; noise_budget > 1: largest factor on the rms of a command."""

@overload
def lqr(vehicle: VehicleLike, *, Q: Optional[Numbers] = None, R: Optional[Numbers] = None, integral: Optional[Names] = None, dt: Optional[float] = None, plant: Optional[str] = None, structure: Optional[str] = None, change: Optional[Numbers] = None, past: Optional[int] = None, estimator: str = '', sensors: str = '', height: float = 1.1, at: Optional[str] = None, speed: Optional[float] = None, climb: Optional[float] = None, radius: Optional[float] = None, yaw_rate: Optional[float] = None, yaw: Optional[float] = None, convention: Optional[str] = None, inputs: Optional[str] = None, states: Optional[Names] = None, method: Optional[str] = None, evidence: Optional[str] = None) -> Union[FlownLqr, MatrixLqr, IdealLqr]:
    """State feedback of a vehicle about a trim.

    plant: "flown" (default) includes motor lag, delays of sensors and the estimator and
    returns FlownLqr, with structure="matrix" MatrixLqr; "ideal", which the arguments
    from `at` on imply, is the textbook plant and returns IdealLqr. Q: weights >= 0 of the
    states, then of the integrals; R > 0: of the inputs; one number stands for all.
    Default: Bryson's rule, on the ideal plant 1. integral: states to integrate. dt > 0:
    sample period [s], by default 0.005. change >= 0: weights of the changes of the
    commands. past >= 0: control periods by which the law predicts. estimator, sensors as
    fly(); height > 0 of the hover [m]. at to states as linearize(); method:
    "continuous", "discrete" (weights per step) or "sampled" (exact cost); evidence:
    "none", "essential" or "full" margins. An ideal problem without solution is a
    result with solved == False. Raises NoSolution if there is no trim or no law on the
    flown plant, InvalidInput for a wrong argument, FileError if a file cannot be read."""
@overload
def lqr(A: npt.ArrayLike, B: npt.ArrayLike, Q: npt.ArrayLike, R: npt.ArrayLike, N: Optional[npt.ArrayLike] = None, *, C: Optional[npt.ArrayLike] = None, D: Optional[npt.ArrayLike] = None, delay: int = 0, discrete: bool = False, sampled: Optional[float] = None, dt: Optional[float] = None, evidence: Optional[str] = None) -> Lqr:
    """The LQR gain of matrices.

    A (nx, nx), B (nx, nu), Q (nx, nx) symmetric and >= 0, R (nu, nu) symmetric and > 0, N
    (nx, nu) or None for zero. Continuous by default; discrete=True for a sampled plant
    with weights per step, dt > 0 [s] (1 by default) its period; sampled > 0 [s] for the
    continuous problem with the input held for so long. C (ny, nx) and D (ny, nu): outputs
    whose integrals are fed back; Q and N then have ny more rows, those of the integrals.
    delay: 0 to 2000 samples by which the input acts late, unless continuous. evidence:
    "none", "essential" (each loop) or "full" (and all loops at once); None for as
    much as takes about a second. A problem without solution is a result whose status is
    not "solved" and whose riccati.culprit names the mode. Raises InvalidInput for wrong
    shapes, entries that are not finite and weights out of range."""

@overload
def margins(vehicle: VehicleLike, gains: Path, *, plant: str = 'flown', estimator: str = '', sensors: str = '', height: float = 1.1, delay: float = 0.0, skew: float = 0.0) -> Loop:
    """Margins of a vehicle with gains.

    gains: an export, a file of gains or a design file. plant: "flown" with motor lag,
    sensors and estimator, or "ideal", the textbook plant with 12 states. estimator and
    sensors as fly(). height > 0 of the hover [m]. delay >= 0 of the commands [s]. skew: on
    the ideal plant alone. Raises InvalidInput for unknown words, numbers out of range and
    gains of another vehicle, NoSolution if a design file has none, FileError if a file
    cannot be read."""
@overload
def margins(*, num: Numbers, den: Numbers, delay: float = 0.0, dt: Optional[float] = None, controller: Optional[Controller] = None, cut: Optional[str] = None, skew: float = 0.0) -> Loop:
    """Margins of a transfer function under negative feedback.

    num, den: coefficients in descending powers of s, or of z with dt > 0 [s]: the open
    loop, or with a controller the plant. delay >= 0 [s], a whole number of samples with
    dt. cut: with a controller, "inputs" (default) or "outputs" of the plant. skew of
    the disk margins: 0 balances S and T, 1 is that of S, -1 that of T. Raises InvalidInput
    for coefficients without a loop, and for numbers out of range."""
@overload
def margins(A: npt.ArrayLike, B: npt.ArrayLike, K: npt.ArrayLike, *, cut: str = 'inputs', delay: float = 0.0, dt: Optional[float] = None, sampled: Optional[float] = None, skew: float = 0.0) -> Loop:
    """Margins of u = -K x.

    A (nx, nx), B (nx, nu), K (nu, nx): continuous; with dt > 0 [s] discrete; with sampled
    > 0 [s] continuous, and the input is held for so long. cut: "inputs" or "states".
    delay >= 0 [s], a whole number of samples unless continuous. skew as for a transfer
    function. Raises InvalidInput for wrong shapes and numbers out of range."""
@overload
def margins(A: npt.ArrayLike, B: npt.ArrayLike, *, C: npt.ArrayLike, D: Optional[npt.ArrayLike] = None, controller: Optional[Controller] = None, cut: str = 'inputs', delay: float = 0.0, dt: Optional[float] = None, sampled: Optional[float] = None, skew: float = 0.0) -> Loop:
    """Margins of a loop A, B, C, D, or of a controller times this plant.

    A (nx, nx), B (nx, nu), C (ny, nx), D (ny, nu) or None for zero; without a controller
    they are the open loop, with ny = nu. cut: with a controller, "inputs" or "outputs"
    of the plant. delay, dt, sampled and skew as for a gain; a PID controller of a sampled
    loop is discretized. Raises InvalidInput for wrong shapes and numbers out of range."""
@overload
def margins(*, w: Numbers, G: ComplexNumbers, measured: str = 'loop', controller: Optional[Controller] = None, dt: Optional[float] = None, delay: float = 0.0, skew: float = 0.0) -> MeasuredLoop:
    """Margins of a measured frequency response.

    w (n): frequencies > 0 [rad/s], increasing, n >= 2. G (n): complex, not 0. measured:
    "loop" (L, or with a controller the plant), "T" = L/(1 + L) or "S" = 1/(1 + L).
    dt > 0 [s]: the controller is discrete. delay >= 0 [s] in addition to the measured one.
    skew as for a transfer function. Between frequencies, log|L| and the phase are linear
    in log w; nothing is extrapolated. Stability is assumed. Raises InvalidInput for wrong
    data."""
@overload
def margins(*, frd: Path, measured: str = 'loop', controller: Optional[Controller] = None, dt: Optional[float] = None, delay: float = 0.0, skew: float = 0.0) -> MeasuredLoop:
    """The same of a file.

    frd: a text with one row per frequency. Its first line names the columns: w [rad/s] or
    f [Hz]; re and im, or mag or mag_db with phase_deg or phase_rad. Raises FileError if it
    cannot be read, and InvalidInput with "file:line"."""

@overload
def pid(vehicle: VehicleLike, *, method: str = '', plant: str = '', dt: Optional[float] = None, structure: Optional[str] = None, Ms_max: Optional[float] = None, bandwidth: Optional[ByLoop] = None, sensor_delay: Optional[ByLoop] = None, motor_lag: Optional[float] = None, tracking_max: Optional[float] = None, integral: Optional[Names] = None, integrator: Optional[str] = None, free: bool = False, for_firmware: Optional[str] = None, firmware: str = '', setup: str = '', rate_lead: Optional[float] = None) -> Cascade:
    """PID gains for a vehicle's cascade.

    method: "flown" (all gains at once on the flown plant) or "loops". plant: "flown"
    or "ideal", the textbook plant. dt > 0: control period [s], by default that of the
    published gains, or 0.005. structure: "pid" or "p-pi". Ms_max > 1: bound on max
    |S|. bandwidth > 0 [rad/s] and sensor_delay >= 0 [s]: a number for all loops, or a dict
    by loop. motor_lag >= 0: time constant [s], by default that of the vehicle.
    tracking_max > 1: bound on max |value / set point|. integral: loops that have one, by
    default all. integrator: "euler" (default), "backward-euler" or "tustin". free:
    without the bounds of the published gains. for_firmware: "px4", "ardupilot",
    "betaflight" or "crazyflie", whose loops must have margins as well, with its version
    firmware and, for a Crazyflie, its setup. rate_lead >= 0: lead of the rate in the roll
    and pitch loops [s], by default half the motor lag for PX4 and ArduPilot, otherwise 0.
    Raises NoSolution with the loop that cannot be had, InvalidInput for a wrong argument,
    FileError if the vehicle's file cannot be read."""
@overload
def pid(*, num: Numbers, den: Numbers, delay: float = 0.0, type: str = 'PID', crossover: Optional[float] = None, phase_margin: Optional[float] = None, Tf: Optional[float] = None, rule: Optional[str] = None, tau_c: Optional[float] = None, Ms_max: Optional[float] = None, Mt_max: Optional[float] = None, noise_gain_max: Optional[float] = None, dt: Optional[float] = None, integrator: Optional[str] = None) -> Pid:
    """PID gains for a transfer function, in one of three ways.

    num, den: coefficients in descending powers of s; delay >= 0 [s]. crossover > 0 [rad/s]
    with phase_margin, more than 0 and less than 180 [deg]; or rule "amigo", "simc",
    "ziegler-nichols", "cohen-coon" or "lambda" with tau_c > 0 [s] of the closed
    loop; or the largest integral gain with max |S| up to Ms_max > 1 and, if
    given, Mt_max and noise_gain_max. type: "P", "PI", "PD" or "PID". Tf >= 0 [s] of the
    filter of the derivative, unless a rule has its own. dt > 0 [s]: also discretize the
    gains by integrator, "euler", "backward-euler" or "tustin" (default). Raises
    NoSolution with the cause, InvalidInput for a wrong argument."""
@overload
def pid(*, Ku: float, Tu: float, rule: str = 'ziegler-nichols', type: str = 'PID', dt: Optional[float] = None, integrator: Optional[str] = None) -> PidAlone:
    """PID gains from the limit of stability, without a plant.

    Ku: the gain, not 0, at which a proportional loop oscillates; Tu > 0: the period of
    that oscillation [s]. rule: "ziegler-nichols", "pessen", "some-overshoot",
    "no-overshoot" or "tyreus-luyben". type, dt and integrator as for a transfer
    function. Raises InvalidInput for a wrong argument, and for a rule that does not have
    the type."""
@overload
def pid(*, gains: Numbers, dt: float, integrator: Optional[str] = None) -> PidAlone:
    """Discretize given PID gains.

    gains: Kp, Ki [1/s], Kd [s] and Tf >= 0 [s], the last of which may be omitted. dt > 0
    [s] and integrator as for a transfer function. Raises InvalidInput for a wrong
    argument, and where the integrator makes the filter unstable."""

def place(A: npt.ArrayLike, B: npt.ArrayLike, poles: ComplexNumbers, *, dt: Optional[float] = None) -> PolePlacement:
    """State feedback u = -K x with given closed-loop poles.

    A (nx, nx), B (nx, nu), poles (nx): real or complex, complex ones in conjugate pairs,
    repeated ones allowed. dt > 0: the sample period [s] if A and B are discrete, for the
    printed table alone. With several inputs, each pole is moved by the smallest gain that
    moves it. A mode that cannot be moved is a result whose status is not "solved" and
    whose culprit names it. Raises InvalidInput for wrong shapes, entries that are not
    finite, and a complex pole without its conjugate."""

def schedule(vehicle: VehicleLike, grid: Grid, *, Q: Optional[Numbers] = None, R: Optional[Numbers] = None, integral: Optional[Names] = None, method: str = 'continuous', dt: Optional[float] = None, yaw: float = 0.0, convention: str = 'ned', inputs: str = 'rotor-speed', states: Optional[Names] = None, threads: int = 0) -> Schedule:
    """LQR gains of a vehicle over a grid of flights, on the textbook plant.

    grid: a dict from quantities to increasing values, or "speed=0:0.5:10,
    yaw_rate=-2:1:2" (first:step:last). Quantities: speed >= 0 [m/s], climb [m/s] upward,
    yaw_rate [rad/s] clockwise from above, mass > 0 and density > 0 as ratios to those of
    the vehicle; at most 100000 points. Q: weights >= 0 of the states, then of the
    integrals; R > 0: of the inputs; one number stands for all, 1 by default. integral:
    states to integrate. method: "continuous", "discrete" (weights per step) or
    "sampled" (exact cost), the last two with dt > 0, the sample period [s]. yaw: heading
    [rad]. convention, inputs and states as linearize(). threads: 0 for one of each
    processor; the result does not depend on it. Raises NoSolution if no point has a gain,
    InvalidInput for a wrong argument, FileError if a file cannot be read."""

def tune_kalman(model: Path, logs: List[Path], *, map: Dict[str, str] = {}, truth: Dict[str, str] = {}, method: str = 'ml', fix: Names = [], start: Dict[str, float] = {}, holdout: float = 0.2, gate: float = 0.0, student: float = 0.0, starts: int = 3, budget: Optional[float] = None, profile: bool = False, format: str = '', columns: str = '', rate: Optional[float] = None, seed: int = 1, threads: int = 0) -> TunedKalman:
    """Estimate the noise covariances of a filter from logs of its sensors.

    model: a built-in filter model or a file. logs: one file of each flight. map: channels
    of inputs and measurements that have other names in the log. truth: channels of what
    states truly were. method: "ml" (maximum likelihood) or "als" (autocovariances).
    fix: parameters that stay; start: variances > 0 at which the search starts. holdout:
    share of each log that is kept for the verdict, 0 to 0.9. gate > 0: measurements whose
    squared innovation exceeds it are left out; student > 0: degrees of freedom of the
    measurement errors; 0 for neither. starts: 1 to 1000 searches. budget > 0: time of the
    search [s], which then ends with the best it has. profile: intervals by the likelihood
    profile. format and columns of the logs, rate > 0 [Hz] of logs without times:
    docs/cli.md. threads: 0 for one of each processor. A problem without fit is a result
    whose status is "not computed". Raises InvalidInput for a wrong argument, model or
    log, FileError if a file cannot be read."""

@overload
def tune_lqr(vehicle: VehicleLike, missions: List[Path] = [], *, requirements: Optional[Path] = None, Q: Optional[Numbers] = None, R: Optional[Numbers] = None, integral: Optional[Names] = None, method: str = 'sampled', dt: Optional[float] = None, yaw: float = 0.0, convention: str = 'ned', inputs: Optional[str] = None, states: Optional[Names] = None, separate: bool = False, budget: float = 60.0, evaluations: int = 100000, draws: int = 0, proof: int = 0, measure: str = '', estimator: str = '', sensors: str = '', wind: str = '', duration: Optional[float] = None, seed: int = 1, threads: int = 0) -> TunedLqr:
    """Search LQR weights over missions, and prove the gains on fresh draws.

    Q: where the search starts: weights >= 0 of the states, then of the integrals; R > 0:
    of the inputs; one number stands for all, 1 by default; a weight of 0 stays 0. Without
    Q and R: Bryson's rule, for all states in ned and the wrench. integral: states to
    integrate. method: "sampled" (exact cost) or "discrete" (weights per step). dt > 0:
    sample period [s], by default 0.005. yaw: heading of the hover [rad]. convention,
    inputs and states as linearize(). separate: the weights of x and y, and of roll and
    pitch, are searched separately. The other arguments, and the exceptions, as tune_pid()."""
@overload
def tune_lqr(vehicle: VehicleLike, *, match_gains: Path, Q: Optional[Numbers] = None, R: Optional[Numbers] = None, integral: Optional[Names] = None, method: Optional[str] = None, dt: Optional[float] = None, at: Optional[str] = None, speed: Optional[float] = None, climb: Optional[float] = None, radius: Optional[float] = None, yaw_rate: Optional[float] = None, yaw: Optional[float] = None, convention: Optional[str] = None, inputs: Optional[str] = None, states: Optional[Names] = None, tie: List[Names] = [], tolerance: float = 0.001, starts: int = 8, seed: int = 1) -> GainMatch:
    """Compute diagonal LQR weights that give a known gain.

    match_gains: an export, a file of gains, or a design file with [published] gains, from
    which absent arguments take their values. Q, R: where the search starts, as for
    missions; the geometric mean of R is kept, because a gain determines the weights only
    up to a factor. method: "continuous", "discrete" or "sampled". at to states as
    linearize(). tie: lists of states, integrals (as int_x) or inputs that share one
    weight. tolerance > 0: largest difference of an entry that counts as matched, relative
    to the largest of its row or column. starts: 1 to 1000 searches. A gain that no weights
    give is a result whose status is "not matched". Raises NoSolution if the gain does
    not stabilize the plant, InvalidInput for a wrong argument or file, and FileError."""

def tune_pid(vehicle: VehicleLike, missions: List[Path] = [], *, requirements: Optional[Path] = None, gains: str = 'designed', separate: bool = False, budget: float = 60.0, evaluations: int = 100000, draws: int = 0, proof: int = 0, measure: str = '', estimator: str = '', sensors: str = '', wind: str = '', duration: Optional[float] = None, seed: int = 1, threads: int = 0) -> TunedPid:
    """Search the gains of a PID cascade over missions, and prove them on fresh draws.

    missions: built-in names or files; or requirements: a file with cost and limits. gains:
    where the search starts: "designed", "published" or a file. separate: x and y, and
    roll and pitch, have gains of their own. budget > 0: time of the search [s];
    evaluations >= 1: the most points it tries. draws of each mission for one evaluation, 0
    for those of the requirements or 4; proof: fresh draws, 0 for 24 or as many as a
    quantile needs. measure of the draws: "mean" (default), "quantile" or "worst".
    estimator, sensors and wind as fly(); duration > 0 of each flight [s]. threads: 0 for
    one of each processor. Raises InvalidInput for a wrong argument or file, FileError, and
    NoSolution if the start is unstable."""

def vehicle(vehicle: VehicleLike) -> Vehicle:
    """Load a built-in vehicle by name, or a vehicle file (TOML).

    Raises InvalidInput with "file:line" for an unknown name or a wrong file, FileError
    if it cannot be read."""

def vehicles() -> List[str]:
    """Names of the built-in vehicles."""

def verify(directory: Path, *, vehicle: Optional[VehicleLike] = None, design: Optional[Path] = None, arm: bool = False) -> Verification:
    """Read an export back as the flight program would, and check everything in it.

    directory: of the export. vehicle: where the manifest's is not built in. design: the
    design file that it was made from, to solve it again and compare. arm: compile flight
    code for ARM as well. A wrong export is a result with ok == False. Raises InvalidInput
    for a manifest that cannot be understood, FileError if files cannot be read."""
