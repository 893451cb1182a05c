"""Ctrl-C in long work, and how fast many onsets are."""

import os
import signal
import subprocess
import sys
import time

import aerodeck
import numpy as np
import pytest

LONG = """
import aerodeck, numpy as np, os
section, model = aerodeck.Section.table_4_1(), aerodeck.fit_laguerre(aerodeck.Derivatives.deck("LN21-5200"))
def told(done, total):
    if done * 2 < total:
        # one piece, whichever thread writes
        os.write(1, b"working\\n")
try:
    {call}
except KeyboardInterrupt:
    # the interpreter and the library go on
    onset = aerodeck.flutter(section, model)
    print("ended", onset.state)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize(
    "call",
    [
        "aerodeck.onsets(section, model, {'torsion.frequency_hz': np.linspace(4, 6, 50_000_000)}, progress=told)",
        "aerodeck.monte_carlo(section, model, {'torsion.frequency_hz': {'kind': 'lognormal', 'coefficient_of_variation': 0.05}},"
        " samples=50_000_000, progress=told)",
        "os.write(1, b'working\\n'); aerodeck.sweep(section, model, np.linspace(1, 40, 3_000_000))",
    ],
    ids=["onsets", "monte_carlo", "sweep"],
)
def test_interrupt_ends_long_work(call):
    """A run of minutes ends within a second or two, with KeyboardInterrupt and without a word."""
    assert interrupted(LONG.replace("{call}", call))[-1] == "ended onset"


def interrupted(script):
    """Lines of a script that is interrupted while it works, and ends well soon after."""
    # whoever runs the tests in the background may have told them to ignore the signal
    heed = lambda: signal.signal(signal.SIGINT, signal.default_int_handler)  # noqa: E731
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", script], stdout=pipe, stderr=pipe, text=True, preexec_fn=heed) as work:
        assert work.stdout.readline() == "working\n"
        asked = time.monotonic()
        work.send_signal(signal.SIGINT)
        out, err = work.communicate(timeout=60)
        assert time.monotonic() - asked < 20
    assert (err, work.returncode) == ("", 0)
    return out.splitlines()


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_interrupt_ends_a_simulation():
    """What is left undone takes no memory: all steps would be kept in two gigabytes."""
    call = "os.write(1, b'working\\n'); aerodeck.simulate(section, model, 30.0, stop_time_s=1e4, step_s=1e-3)"
    peak = "import resource; print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    out = interrupted(LONG.replace("{call}", call) + peak)
    assert out[-2] == "ended onset"
    assert int(out[-1]) < 1_000_000  # kilobytes


def test_what_a_callback_raises_ends_the_work():
    told = []

    def stop(done, total):
        told.append(done)
        raise KeyError("stop")

    section, model = aerodeck.Section.table_4_1(), aerodeck.fit_laguerre(aerodeck.Derivatives.deck("LN21-5200"))
    with pytest.raises(KeyError, match="stop"):
        aerodeck.onsets(section, model, {"torsion.frequency_hz": np.linspace(4, 6, 1_000_000)}, progress=stop)
    assert max(told) < 500_000


def test_many_onsets_from_arrays_say_how_fast_they_are(capsys):
    section, model = aerodeck.Section.table_4_1(), aerodeck.fit_laguerre(aerodeck.Derivatives.deck("LN21-5200"))
    count = 200_000
    begun = time.perf_counter()
    found = aerodeck.onsets(section, model, {"torsion.frequency_hz": np.linspace(4, 6, count)})
    per_second = count / (time.perf_counter() - begun)
    with capsys.disabled():
        print(f"\n{per_second:.0f} onsets per second on {os.cpu_count()} cores")
    assert np.all(np.diff(found.speed_m_s) > 0)
