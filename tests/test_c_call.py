"""The C file of a law tells how it is called: those very lines are compiled and called here."""

import shutil

import casadi as ca
import numpy as np
import pytest
from helpers import called_in_c

from bridgectl.dampers import SIGNALS, Strategy
from bridgectl.dampers.loop.batch_law import BatchLaw

GAINS = {"share": (0.4, 0.0, 1.0), "dead_band": (1e-3, 0.0, 1.0)}


def pulled(s, g):
    return g.share * 30e3 * ca.fabs(s.body_velocity) + ca.if_else(s.axle_velocity > 0, 2e3, 0)


def remembered(s, g):
    return 1e3 + 1e5 * ca.fabs(s.low) + 1e5 * ca.fabs(s.ahead[1] - s.ahead[0])


LAWS = {
    "with gains": Strategy("pulled */ through", pulled, 1e3, 30e3, gains=GAINS),
    "without": Strategy("plain", lambda s, g: 1e5 * s.suspension_velocity**2, 1e3, 30e3),
    "with states and preview": Strategy(
        "remembered", remembered, 1e3, 30e3, states={"low": 0.01, "n": 0.0}, preview=[0.5, 1.0],
        update=lambda s, g: {
            "low": s.low + s.sample_time * 10 * (s.body_velocity - s.low), "n": s.n + s.low},
    ),
}  # fmt: skip


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(
    ("options", "within"),
    [((), 1e-12), (("-Dcasadi_real=float", "-Dcasadi_int=int"), 1e-5)],
    ids=["double", "single"],
)
def test_the_lines_at_the_head_of_a_c_file_call_its_law_sample_by_sample(
    name, options, within, tmp_path
):
    law, rng = LAWS[name], np.random.default_rng(3)
    once = called_in_c(law, tmp_path, *options)
    batch = BatchLaw(law, [25.0], sample_time=2e-3)
    memory = batch.start(1, 1)
    commands = []
    for _ in range(30):
        values = rng.normal(0, 0.2, len(SIGNALS))
        signals = dict(zip(SIGNALS, values.reshape(-1, 1, 1), strict=True))
        level = np.zeros((1, len(law.preview), 1))
        expected, memory = batch.command(signals, memory, level)
        commands.append(once(*values))
        assert commands[-1] == pytest.approx(float(expected[0, 0]), rel=within)
    assert np.ptp(commands) > 1e3  # [N s/m]: neither bound alone


def test_the_head_of_a_c_file_tells_what_a_law_measures_and_how_precise_it_may_be(tmp_path):
    text = LAWS["with gains"].to_c(tmp_path / "law.c").read_text(encoding="utf-8")
    head = text.partition("*/")[0]
    assert "It measures body_velocity, axle_velocity; other signals may be 0." in head
    assert "{0.4, 0.001};  // share, dead_band" in head
    assert "pulled * / through, a damping from 1000 to 30000 N s/m" in head
    assert "casadi_real=float" in head
    nothing = Strategy("held", lambda s, g: 5e3, 1e3, 30e3).to_c(tmp_path / "law.c")
    assert "It measures nothing" in nothing.read_text(encoding="utf-8")
