# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends long calls, and the lock of the interpreter is released in them."""

import os
import signal
import subprocess
import sys
import threading

import pytest

import quadtune

# A shell starts background jobs with SIGINT ignored, and a process inherits that.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The call would take hours. A thread that waits for the lock of the interpreter sends the signal;
# with this switch interval it has the lock only once the call has released it.
SCRIPT = """
import os, signal, sys, threading
import quadtune
signal.signal(signal.SIGINT, signal.default_int_handler)
begun = threading.Event()

def interrupt():
    begun.wait()
    {when}
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
sys.setswitchinterval(1000)
try:
    begun.set()
    {call}
except KeyboardInterrupt:
    print("interrupted")
"""


def interrupted(call, when="pass", folder=None):
    done = subprocess.run([sys.executable, "-c", SCRIPT.format(call=call, when=when)], cwd=folder,
                          capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("call", [
    "quadtune.fly('mambo', duration=1e6, log=False)",
    "quadtune.fly('mambo', duration=1e5, seeds=1000, log=False)",
    "quadtune.tune_pid('mambo', ['hover'], budget=1e6)",
    "quadtune.tune_lqr('mambo', ['hover'], budget=1e6)",
    "quadtune.schedule('mambo', 'speed=0:0.0001:5')",
])
def test_ctrl_c_ends_a_long_call(call):
    assert interrupted(call) == "interrupted\n"


def test_ctrl_c_ends_a_campaign_and_keeps_what_was_flown(tmp_path):
    (tmp_path / "long.toml").write_text(
        'name = "long"\nvehicle = "mambo"\nflights = 1000000\n[[design]]\nname = "one"\n'
        'gains = "published"\n[[mission]]\nmission = "hover"\nduration_s = 5\n')
    # Once the plan is there the flights begin.
    when = "import time\n    while not os.path.exists('out/plan.json'): time.sleep(0.01)"
    assert interrupted("quadtune.campaign('long.toml', 'out')", when, tmp_path) == "interrupted\n"
    assert (tmp_path / "out" / "plan.json").exists()
    assert not (tmp_path / "out" / "statistics.json").exists()


def test_a_handler_of_the_callers_own_is_called():
    """Its exception is that of the call."""
    class Stopped(Exception):
        pass

    def stop(*_):
        raise Stopped

    before = signal.signal(signal.SIGALRM, stop)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(Stopped):
            quadtune.fly("mambo", duration=1e6, log=False)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_other_threads_run_meanwhile():
    """A thread that needs the lock ends the call: without the lock released it would never run."""
    def interrupt():
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Timer(0.05, interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        quadtune.fly("mambo", duration=1e6, log=False)
    thread.join()


def test_a_call_from_another_thread_gives_its_result():
    flights = []
    threads = [threading.Thread(target=lambda seed=seed: flights.append(
        quadtune.fly("mambo", duration=2, seed=seed, log=False))) for seed in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(flight.seed for flight in flights) == [1, 2]
    alone = quadtune.fly("mambo", duration=2, seed=2, log=False)
    assert alone.metrics in [flight.metrics for flight in flights]
