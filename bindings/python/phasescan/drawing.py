"""Pictures with matplotlib, where it is there."""
from __future__ import annotations

from typing import Any

import numpy as np

from ._core import MatchResult, Scan, SlamResult, TrinaryMap

BEFORE, NOW, WAY = "#1f77b4", "#d62728", "#2ca02c"


def plot(what: Scan | MatchResult | TrinaryMap | SlamResult, *, reference: Scan | None = None, scan: Scan | None = None,
         ax: Any = None) -> Any:
    """Draws a scan, a match, a map or a finished run.

    Parameters
    ----------
    what : Scan, MatchResult, TrinaryMap or SlamResult
        A match is drawn with its two scans, the scan laid onto the reference; without them as poses: where the reference
        stood, where the scan did, with the region that holds 95 % of (x, y) by the covariance, and the alternatives. A run
        is drawn as its map with the trajectory.
    reference, scan : Scan, optional
        Of a match: both or none.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure unless given.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ImportError
        Without matplotlib.
    """
    axes = _axes(ax)
    if isinstance(what, Scan):
        _draw_scan(axes, what)
    elif isinstance(what, MatchResult):
        _draw_match(axes, what, reference, scan)
    elif isinstance(what, TrinaryMap):
        _draw_map(axes, what)
    elif isinstance(what, SlamResult):
        _draw_map(axes, what.map)
        axes.plot(what.poses[:, 0], what.poses[:, 1], color=WAY, linewidth=1.0)
    else:
        raise TypeError(f"plot: expected a Scan, a MatchResult, a TrinaryMap or a SlamResult, got {type(what).__name__}")
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    return axes


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("phasescan.plot needs matplotlib (Debian: python3-matplotlib)") from error
    return plt.figure().add_subplot()


def _draw_scan(axes: Any, scan: Scan) -> None:
    points = scan.points()
    axes.scatter(points[:, 0], points[:, 1], s=4, color=BEFORE)
    axes.plot([0.0], [0.0], marker="^", color=NOW)


def _draw_match(axes: Any, result: MatchResult, reference: Scan | None, scan: Scan | None) -> None:
    if reference is not None and scan is not None:
        before, now = reference.points(), result.pose.transform(scan.points())
        axes.scatter(before[:, 0], before[:, 1], s=4, color=BEFORE, label="reference")
        axes.scatter(now[:, 0], now[:, 1], s=4, color=NOW, label="scan, laid onto it")
    elif reference is None and scan is None:
        _draw_poses(axes, result)
    else:
        raise TypeError("plot: one scan of a match is missing; expected plot(match, reference=..., scan=...), or plot(match)")
    axes.legend()
    axes.set_title(f"{'usable' if result.usable else result.status}"
                   + (f", confidence {result.confidence:.3f}" if result.confidence is not None else ""))


def _draw_poses(axes: Any, result: MatchResult) -> None:
    """Where the sensors stood, in the reference's frame; arrows of a length that the picture has room for."""
    poses = np.array([[0.0, 0.0, 0.0], [*result.pose], *([*other.pose] for other in result.alternatives)])
    farthest = max(0.5, float(np.hypot(poses[:, 0], poses[:, 1]).max()))
    for (x, y, theta), color, label in zip(poses, (BEFORE, NOW, *("0.6" for _ in result.alternatives)), ("reference", "scan", *(None for _ in result.alternatives))):
        axes.quiver(x, y, 0.2 * farthest * np.cos(theta), 0.2 * farthest * np.sin(theta), color=color, label=label, angles="xy",
                    scale_units="xy", scale=1.0, width=0.006)
    # 5.991: what 95 % of the squared distances of two numbers are below. Wider than 100 m is not known at all.
    values, vectors = np.linalg.eigh(np.asarray(result.covariance)[:2, :2])
    half_axes = np.minimum(np.sqrt(5.991 * np.maximum(values, 0.0)), 100.0)
    turn = np.linspace(0.0, 2.0 * np.pi, 100)
    region = (vectors * half_axes) @ np.stack([np.cos(turn), np.sin(turn)])
    axes.plot(result.pose.x + region[0], result.pose.y + region[1], color=NOW, linewidth=1.0)
    axes.set_xlim(-1.4 * farthest, 1.4 * farthest)
    axes.set_ylim(-1.4 * farthest, 1.4 * farthest)


def _draw_map(axes: Any, grid: TrinaryMap) -> None:
    shade = np.full(grid.cells.shape, 0.8)
    shade[grid.cells == 0] = 1.0
    shade[grid.cells == 100] = 0.0
    # The origin's yaw is 0 in maps of this library; one that is not is drawn along its own axes.
    left, low = grid.origin.x, grid.origin.y
    right, top = left + grid.width * grid.resolution_m, low + grid.height * grid.resolution_m
    axes.imshow(shade, cmap="gray", vmin=0.0, vmax=1.0, origin="lower", extent=(left, right, low, top), interpolation="nearest")
