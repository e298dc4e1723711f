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
        """Of the loop as it is sampled."""
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
        """What was written."""
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
        """[byte]"""

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
        """"seen", "at zero", "not seen", ..."""

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
        """Control periods after which the sample clocks repeat."""
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
        """(nu, nx)"""
    @property
    def K_int(self) -> Array:
        """(nu, ni)"""
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

class Gains:
    """u = u0 + K (x_sp - x) + K_int integral(x_sp - x), with what is needed to apply it."""

    @property
    def K(self) -> Array:
        """(nu, nx)"""
    @property
    def K_int(self) -> Array:
        """(nu, ni)"""
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
        """Of the loop as it is sampled."""
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
        """[s]; 1 of a discrete model, 0 of a continuous filter."""
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
        """(nx, nx)"""
    @property
    def B(self) -> Array:
        """(nx, nu)"""
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
        """Of the open loop (nx, nx), the delay left out."""
    @property
    def B(self) -> Array:
        """(nx, n)"""
    @property
    def C(self) -> Array:
        """(n, nx)"""
    @property
    def D(self) -> Array:
        """(n, n)"""
    @property
    def dt(self) -> float:
        """Sample period [s]; 0 of a continuous loop."""
    @property
    def delay(self) -> float:
        """Delay of a continuous loop [s]."""
    @property
    def poles(self) -> ComplexArray:
        """Of the closed loop, the delay left out."""
    @property
    def names(self) -> List[str]:
        """Names of the channels."""
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
    def bode(self, channel: Union[int, str] = 0) -> LoopCurves:
        """The frequency response of a channel, by its number or name, with all others closed:
        of the ideal loop of a vehicle, as `quadtune margins --plot` draws it."""
    def nyquist(self, channel: Union[int, str] = 0) -> LoopCurves:
        """The same as bode(): L is the Nyquist curve."""
    def step(self, channel: Union[int, str] = 0, duration: float = 0.0) -> Step:
        """The output of a channel after a step of its set point. duration [s]; 0 chooses one."""
    def response(self, w: npt.ArrayLike, channel: Union[int, str] = 0) -> ComplexArray:
        """L at given frequencies [rad/s], complex."""
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
        """By frequency."""
    @property
    def phase_crossovers(self) -> List[PhaseCrossover]:
        """By frequency."""
    @property
    def gain_margin(self) -> float:
        """Smallest factor > 1 that brings L to -1; may be infinite."""
    @property
    def gain_reduction(self) -> float:
        """Largest factor < 1 that brings L to -1; 0 for none."""
    @property
    def phase_margin(self) -> float:
        """[rad]; may be infinite."""
    @property
    def crossover(self) -> float:
        """Frequency of the phase margin [rad/s]."""
    @property
    def delay_margin(self) -> float:
        """[s]; may be infinite."""
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
        """Disk margin."""

class Lqg:
    """State feedback together with its filter."""

    @property
    def gains(self) -> Gains:
        """The gains with their names."""
    @property
    def K(self) -> Array:
        """(nu, nx)"""
    @property
    def K_int(self) -> Array:
        """(nu, ni)"""
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
    """The LQR gain of u = -K x of matrices, with its evidence."""

    @property
    def riccati(self) -> Riccati:
        """The solution of the Riccati equation."""
    @property
    def status(self) -> str:
        """"solved", "not stabilizable", ..."""
    @property
    def solved(self) -> bool:
        """Whether status is "solved"."""
    @property
    def K(self) -> Array:
        """(nu, nx); NaN unless solved."""
    @property
    def S(self) -> Array:
        """Cost matrix: x'Sx is the cost from x."""
    @property
    def poles(self) -> ComplexArray:
        """Of the closed loop."""
    @property
    def margins(self) -> MarginsReport:
        """At the inputs u1, u2, ..."""
    @property
    def dt(self) -> float:
        """[s]; 0 of a continuous loop, 1 of a discrete problem."""
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

class MatrixLqr:
    """Gains for programs that hold matrices alone, designed on the flown plants."""

    @property
    def gains(self) -> Gains:
        """The gains with their names."""
    @property
    def K(self) -> Array:
        """(nu, nx)"""
    @property
    def K_int(self) -> Array:
        """(nu, ni)"""
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
        """Time constant of the derivative's filter [s]."""
    @property
    def type(self) -> str:
        """"P", "PI", "PD" or "PID"."""
    @property
    def how(self) -> str:
        """How the gains were computed, in words."""
    @property
    def margins(self) -> MarginsReport:
        """Of the loop."""
    def to_json(self) -> str:
        """The text that `quadtune pid --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune pid --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune pid --json -o FILE` writes."""

class PidLoop:
    """output = Kp error + Ki integral(error) + Kd measured rate"""

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

class PredictedRms:
    """Standard deviations that the noise of the sensors causes in calm air."""

    @property
    def time(self) -> float:
        """Since the vehicle was at rest [s]."""
    @property
    def state(self) -> Array:
        """(12) of the true states."""
    @property
    def error(self) -> Array:
        """(12) of the errors of the estimates."""
    @property
    def command(self) -> Array:
        """(nu) of the commands."""
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
        """Eigenvalues of A - B K."""
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

class SimultaneousDiskMargin:
    """The disk in which the factors of all loops may be at once."""

    @property
    def guaranteed(self) -> DiskMargin:
        """A disk that is safe."""
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

class TunedPid:
    """PID gains that were searched over missions."""

    @property
    def accepted(self) -> bool:
        """Whether fresh draws prove that the gains found are better."""
    @property
    def reason(self) -> str:
        """Why, in words."""
    @property
    def loops(self) -> List[PidLoop]:
        """PidLoop of the gains that count: the start where nothing better was accepted."""
    @property
    def start(self) -> List[PidLoop]:
        """PidLoop of the start."""
    @property
    def candidate(self) -> List[PidLoop]:
        """PidLoop of the best point of the search, accepted or not."""
    @property
    def costs(self) -> Array:
        """Cost of each point, in the order in which they were tried; NaN of an unstable one."""
    @property
    def evaluations(self) -> int:
        """Points that were tried."""
    def save_design(self, file: Path) -> None:
        """Write the candidate as a design file, which states the reason."""
    def to_json(self) -> str:
        """The text that `quadtune tune pid V --json` prints."""
    def to_dict(self) -> dict:
        """The object that `quadtune tune pid V --json` prints, as Python objects."""
    def save(self, file: Path) -> None:
        """Write the object that `quadtune tune pid V --json -o FILE` writes."""

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
        """[kg]"""
    @property
    def inertia(self) -> Array:
        """(3, 3) about the centre of mass [kg m2]."""
    @property
    def rotors(self) -> List[Rotor]:
        """The rotors, numbered from 1 in messages."""
    @property
    def gravity(self) -> float:
        """[m/s2]"""
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
        """Of the closed loop of these gains."""
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

def campaign(file: Path, folder: Optional[Path] = None, *, shards: int = 0, threads: int = 0) -> Campaign:
    """Plan, fly and merge a campaign on this machine.

    file: a campaign file (docs/formats.md). folder: a new one, or one where this was
    stopped, which continues there; default: the file's name with -campaign, in the
    current folder. threads: 0 for one a processor. Ctrl-C ends it; what was flown stays."""

def certify(directory: Path, *, vehicle: Optional[VehicleLike] = None, controller: str = '', mass: Tuple[float, float] = (0.9, 1.1), inertia: Tuple[float, float] = (0.8, 1.2), thrust: Tuple[float, float] = (0.9, 1.1), delay: Optional[Tuple[float, float]] = None, lag: Optional[Tuple[float, float]] = None, integrator: Optional[str] = None, plant: str = 'flown', budget: int = 20000, seed: int = 1, threads: int = 0) -> Certificate:
    """Prove the loops of an export stable for every vehicle of a box, or find one that is
    not.

    mass, inertia, thrust: (low, high) ratios to the vehicle's file. delay of the loop
    and lag of the motors: (low, high) [s]; default: up to one period, and the vehicle's.
    budget: boxes that a proof may inspect."""

def check_vehicle(vehicle: VehicleLike) -> VehicleCheck:
    """Check that a vehicle can hover and that its rotors command thrust and all torques.

    Raises NoSolution with the cause if it cannot."""

def compare_methods(vehicle: VehicleLike, dt: float, *, plant: str = 'flown') -> MethodComparison:
    """Compare every sampling method at dt/2, dt and 2 dt on the LQR and PID loops of a
    vehicle. plant: "flown" or "ideal"."""

def design(file: Path, *, directory: Optional[Path] = None, force: bool = False, seeds: Optional[int] = None, seed: int = 1) -> Design:
    """The whole way of a design file: trim, linearize, synthesize, fly, export, verify.

    directory: where exports and pages are written if the design passes; with force
    whatever the outcome. seeds: flights of each mission, 5."""

@overload
def discretize(A: npt.ArrayLike, B: npt.ArrayLike, C: Optional[npt.ArrayLike] = None, D: Optional[npt.ArrayLike] = None, *, dt: float, method: str = 'zoh', prewarp: Optional[float] = None, input_delay: Optional[Numbers] = None, output_delay: Optional[Numbers] = None, inverse: bool = False) -> SampledPlant:
    """Sample a continuous system of matrices, or with inverse=True take a discrete one
    back.

    dt: sample period [s]. method: "zoh", "foh", "impulse", "euler",
    "backward-euler", "tustin" or "matched". prewarp: frequency at which tustin is
    exact [rad/s]. input_delay, output_delay: of each channel, or of all [s]."""
@overload
def discretize(*, num: Numbers, den: Numbers, dt: float, delay: float = 0.0, method: str = 'zoh', prewarp: Optional[float] = None, inverse: bool = False) -> SampledPlant:
    """The same of a transfer function: coefficients in descending powers, delay in seconds."""

def export(source: Path, to: str, directory: Path, *, vehicle: Optional[VehicleLike] = None, name: str = '', precision: str = '', law: str = '', adapter: str = '', imu_calibration: Optional[Path] = None, constants: bool = False, firmware: str = '', setup: str = '', filter_noise: bool = False, force: bool = False) -> Export:
    """Write gains, or what a design gives, for another program.

    source: an export, a gain file, a design file (.toml) or, with to="c", a gain schedule.
    to: "uquad", "mambo", "json", "mat", "c", "px4", "ardupilot", "betaflight" or
    "crazyflie". The other arguments are the options of `quadtune export` (docs/cli.md)."""

def fly(vehicle: VehicleLike, *, mission: Path = 'hover', controller: str = '', gains: Path = '', integrator: str = '', estimator: str = '', flow: str = '', flow_rate: Optional[float] = None, sensors: str = '', wind: str = 'calm', allocation: str = '', take_off: str = '', duration: Optional[float] = None, solver: str = 'bogacki-shampine-3', step: Optional[float] = None, dynamic_environment: bool = False, seed: int = 1, seeds: Optional[int] = None, log: bool = True, diagnose: bool = True) -> Union[Flight, List[Flight]]:
    """Fly a mission in the nonlinear simulation, with a verdict.

    mission: a built-in name or a file. controller: "cascaded-pid", "state-feedback" or
    "firmware". gains: "designed", "published", an export, a gain or design file, or
    what a result's save() wrote. The other words are those of `quadtune fly`
    (docs/cli.md#flights). seeds=N flies N seeds from `seed` on and returns a list.
    log=False keeps no record; diagnose=False does not look for the cause of a failure."""

def kalman(A: npt.ArrayLike, C: npt.ArrayLike, Q: npt.ArrayLike, R: npt.ArrayLike, *, G: Optional[npt.ArrayLike] = None, N: Optional[npt.ArrayLike] = None, discrete: bool = False, sampled: Optional[float] = None) -> Kalman:
    """The steady-state Kalman filter of matrices.

    A (nx, nx), C (ny, nx), Q (nw, nw), R (ny, ny), G (nx, nw) or None for the identity,
    N (nw, ny) or None. Continuous by default, with spectral densities;
    discrete=True with covariances per step; sampled=DT for the continuous model measured
    every DT seconds. Status and culprit are in the result."""

def linearize(vehicle: VehicleLike, *, at: str = 'hover', speed: float = 0.0, climb: float = 0.0, radius: float = 0.0, yaw_rate: float = 0.0, yaw: float = 0.0, convention: str = 'ned', inputs: str = 'rotor-speed', states: Names = 'full') -> Linearization:
    """Trim a vehicle and compute its linear model.

    at: "hover", "line", "circle" or "spin"; speed and climb in m/s, radius in m,
    yaw_rate in rad/s, yaw in rad. convention: "ned", "uquad", "mambo" or a file.
    inputs: "rotor-speed", "rotor-thrust", "wrench" or "command". states: "full",
    "no-position" or names. Raises NoSolution if there is no such trim."""

def load_campaign(folder: Path, *, threads: int = 0) -> Campaign:
    """Merge the flown shards of a campaign, as `quadtune campaign merge` does."""

def lqg(vehicle: VehicleLike, *, Q: Optional[Numbers] = None, R: Optional[Numbers] = None, integral: Optional[Names] = None, dt: Optional[float] = None, change: Optional[Numbers] = None, past: Optional[int] = None, estimator: str = '', sensors: str = '', height: float = 1.1, time: float = 60.0, recover: bool = False, noise_budget: Optional[float] = None) -> Lqg:
    """State feedback and filter of a vehicle together: predicted deviations and margins.

    Arguments as lqr() on the flown plant. time: of the prediction [s]. recover: raise the noise
    that the filter assumes where that gives larger margins; noise_budget: largest factor on
    the rms of a command."""

@overload
def lqr(vehicle: VehicleLike, *, Q: Optional[Numbers] = None, R: Optional[Numbers] = None, integral: Optional[Names] = None, dt: Optional[float] = None, plant: Optional[str] = None, structure: Optional[str] = None, change: Optional[Numbers] = None, past: Optional[int] = None, estimator: str = '', sensors: str = '', height: float = 1.1, at: Optional[str] = None, speed: Optional[float] = None, climb: Optional[float] = None, radius: Optional[float] = None, yaw_rate: Optional[float] = None, yaw: Optional[float] = None, convention: Optional[str] = None, inputs: Optional[str] = None, states: Optional[Names] = None, method: Optional[str] = None, evidence: Optional[str] = None) -> Union[FlownLqr, MatrixLqr, IdealLqr]:
    """State feedback of a vehicle about a trim.

    plant: "flown" (default) includes motor lag, delays of sensors and the estimator and
    returns FlownLqr, with structure="matrix" MatrixLqr; "ideal", which the arguments from
    `at` on imply, is the textbook plant and returns IdealLqr. Q: weights of the states, then of
    the integrals; R: of the inputs; one number stands for all. Default: Bryson's rule, on the
    ideal plant 1. integral: states to integrate. dt: sample period [s]. change: weights of the
    changes of the commands. past: control periods by which the law predicts."""
@overload
def lqr(A: npt.ArrayLike, B: npt.ArrayLike, Q: npt.ArrayLike, R: npt.ArrayLike, N: Optional[npt.ArrayLike] = None, *, discrete: bool = False, sampled: Optional[float] = None, evidence: Optional[str] = None) -> Lqr:
    """The LQR gain of matrices, or of a vehicle.

    A (nx, nx), B (nx, nu), Q (nx, nx), R (nu, nu), N (nx, nu) or None. Continuous by
    default; discrete=True for a sampled plant with weights per step; sampled=DT for the
    continuous problem with the input held for DT seconds. evidence: "none",
    "essential" or "full" margins. A problem without solution is a result whose
    status is not "solved" and whose riccati.culprit names the mode."""

@overload
def margins(vehicle: VehicleLike, gains: Path, *, plant: str = 'flown', estimator: str = '', sensors: str = '', height: float = 1.1, delay: float = 0.0) -> Loop:
    """Margins of a vehicle with gains: an export, a file of gains or a design file.

    plant: "flown" with motor lag, sensors and estimator, or "ideal". estimator and
    sensors as fly(). height of the hover [m]; delay of the commands [s]."""
@overload
def margins(*, num: Numbers, den: Numbers, delay: float = 0.0, dt: Optional[float] = None) -> Loop:
    """Margins of a transfer function under negative feedback.

    num, den: coefficients in descending powers of s, or of z with dt [s]. delay [s]."""
@overload
def margins(A: npt.ArrayLike, B: npt.ArrayLike, K: npt.ArrayLike, *, cut: str = 'inputs', delay: float = 0.0, dt: Optional[float] = None, sampled: Optional[float] = None) -> Loop:
    """Margins of u = -K x.

    A and B are continuous; with dt they are discrete; with sampled they are continuous and
    the input is held for so many seconds. cut: "inputs" or "states"."""

@overload
def pid(vehicle: VehicleLike, *, method: str = '', plant: str = '', dt: Optional[float] = None, structure: Optional[str] = None, Ms_max: Optional[float] = None, bandwidth: Optional[ByLoop] = None, sensor_delay: Optional[ByLoop] = None, motor_lag: Optional[float] = None, tracking_max: Optional[float] = None, integral: Optional[Names] = None, integrator: Optional[str] = None, free: bool = False) -> Cascade:
    """PID gains for a vehicle's cascade.

    method: "flown" (all gains at once on the flown plant) or "loops". plant: "flown"
    or "ideal". dt: sample period [s]. structure: "pid" or "p-pi". bandwidth [rad/s]
    and sensor_delay [s]: a number or a dict by loop. integral: loops that have one.
    integrator: "euler", "backward-euler" or "tustin". free: without the bounds of the
    published gains. Raises NoSolution with the loop that cannot be had."""
@overload
def pid(*, num: Numbers, den: Numbers, delay: float = 0.0, type: str = 'PID', crossover: Optional[float] = None, phase_margin: Optional[float] = None, Tf: Optional[float] = None, rule: Optional[str] = None, tau_c: Optional[float] = None, Ms_max: Optional[float] = None, Mt_max: Optional[float] = None, noise_gain_max: Optional[float] = None) -> Pid:
    """PID gains for a transfer function, in one of three ways.

    crossover [rad/s] with phase_margin [deg]; or rule "amigo", "simc",
    "ziegler-nichols", "cohen-coon" or "lambda" with tau_c [s]; or the largest
    integral gain within Ms_max, Mt_max and noise_gain_max. type: "P", "PI", "PD" or
    "PID". Raises NoSolution with the cause."""

def tune_kalman(model: Path, logs: List[Path], *, map: Dict[str, str] = {}, truth: Dict[str, str] = {}, method: str = 'ml', fix: Names = [], start: Dict[str, float] = {}, holdout: float = 0.2, gate: float = 0.0, student: float = 0.0, starts: int = 3, budget: Optional[float] = None, profile: bool = False, format: str = '', columns: str = '', rate: Optional[float] = None, seed: int = 1, threads: int = 0) -> TunedKalman:
    """Estimate the noise covariances of a filter from logs of its sensors.

    model: a built-in filter model or a file. logs: one file of each flight. map: channels
    of inputs and measurements that have other names in the log. truth: channels of what
    states truly were. method: "ml" or "als". fix: parameters that stay; start:
    variances at which the search starts. holdout: share of each log that is kept for the
    verdict. budget: time of the search [s], which then ends with the best it has."""

def tune_pid(vehicle: VehicleLike, missions: List[Path] = [], *, requirements: Optional[Path] = None, gains: str = 'designed', separate: bool = False, budget: float = 60.0, evaluations: int = 100000, draws: int = 0, proof: int = 0, measure: str = '', estimator: str = '', sensors: str = '', wind: str = '', duration: Optional[float] = None, seed: int = 1, threads: int = 0) -> TunedPid:
    """Search the gains of a PID cascade over missions, and prove them on fresh draws.

    missions: built-in names or files; or requirements: a file with cost and limits.
    gains: where the search starts: "designed", "published" or a file. budget: time of
    the search [s]. draws of each mission for one evaluation; proof: fresh draws.
    measure of the draws: "mean", "quantile" or "worst"."""

def vehicle(vehicle: VehicleLike) -> Vehicle:
    """Load a built-in vehicle by name, or a vehicle file."""

def vehicles() -> List[str]:
    """Names of the built-in vehicles."""

def verify(directory: Path, *, vehicle: Optional[VehicleLike] = None, design: Optional[Path] = None, arm: bool = False) -> Verification:
    """Read an export back as the flight program would, and check everything in it.

    vehicle: where the manifest's is not built in. design: the design file that it was made
    from, to solve it again and compare. arm: compile flight code for ARM as well."""
