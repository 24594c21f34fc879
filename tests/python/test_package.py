"""Docstrings and pictures."""
import inspect

import numpy as np
import pytest
from conftest import look_around

import phasescan

def test_all_that_is_public_is_explained():
    for name in phasescan.__all__:
        item = getattr(phasescan, name)
        if name == "__version__":
            continue
        assert item.__doc__ and len(item.__doc__) > 20, name
        if inspect.isclass(item):
            for member, value in vars(item).items():
                if not member.startswith("_") and member not in ("file", "line", "reason"):
                    assert getattr(value, "__doc__", None), f"{name}.{member}"
    for function in (phasescan.match, phasescan.match_many, phasescan.open_log, phasescan.simulate, phasescan.evaluate, phasescan.live, phasescan.locate, phasescan.plot):
        for part in ("Parameters\n", "Returns\n"):
            assert part in inspect.getdoc(function), function


def test_pictures():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    before, now = phasescan.Scan(look_around()), phasescan.Scan(look_around(0.2, 0.1, 1.0))
    assert phasescan.plot(before).collections[0].get_offsets().shape == (360, 2)
    axes = phasescan.plot(phasescan.match(before, now), reference=before, scan=now)
    laid, on = (c.get_offsets() for c in reversed(axes.collections))
    assert np.abs(laid[:, None] - on[None]).sum(axis=2).min(axis=1).max() < 0.3
    grid = phasescan.TrinaryMap([[0, 100], [-1, 0]], 0.5, (1.0, 2.0, 0.0))
    assert phasescan.plot(grid).images[0].get_extent() == (1.0, 2.0, 2.0, 3.0)
    slam = phasescan.Slam()
    slam.add(before)
    assert phasescan.plot(slam.finish()).lines
    with pytest.raises(TypeError, match="reference="):
        phasescan.plot(phasescan.match(before, now), scan=now)
    with pytest.raises(TypeError, match="got int"):
        phasescan.plot(3)


def test_a_match_without_its_scans_is_drawn_as_poses():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    match = phasescan.match(phasescan.Scan(look_around()), phasescan.Scan(look_around(0.2, 0.1, 1.0)))
    axes = phasescan.plot(match)
    where, scan = (arrows.get_offsets()[0] for arrows in axes.collections[:2])
    assert np.allclose(where, 0.0) and np.allclose(scan, [match.pose.x, match.pose.y])
    region = axes.lines[0].get_xydata() - [match.pose.x, match.pose.y]
    assert np.allclose(np.einsum("ni,ij,nj->n", region, np.linalg.inv(match.covariance[:2, :2]), region), 5.991, rtol=1e-3)
    low, high = axes.get_xlim()
    assert low < 0.0 < high and low < match.pose.x < high
    # A room that looks the same from its other end: the other pose is in the picture, and what is open is no wider than it can show.
    both = np.full(360, 2.0)
    symmetric = phasescan.match(both, both)
    assert all(other.pose == other.T_ref_scan for other in symmetric.alternatives)
    twins = phasescan.plot(symmetric)
    assert len(twins.collections) >= 2 and np.isfinite(twins.lines[0].get_xydata()).all()
