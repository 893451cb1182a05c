"""Pages for notebooks, and plots through matplotlib where it is installed. Nothing is computed here."""

from html import escape

import numpy as np

from ._errors import InputError

# Okabe and Ito: told apart by colour-blind readers; line styles differ as well, for print.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
DASHES = ("-", "--", "-.", ":")


def _pyplot():
    try:
        import matplotlib.pyplot as pyplot
    except ImportError as missing:
        raise ImportError("plots need matplotlib: pip install matplotlib") from missing
    return pyplot


def _panels(ax, count=1, **keywords):
    """The figure and its axes: those that are given, or of a new figure, one below the other."""
    if ax is None:
        figure, axes = _pyplot().subplots(count, 1, sharex=True, layout="constrained", **keywords)
        return figure, np.atleast_1d(axes)
    axes = np.atleast_1d(np.asarray(ax, object)).ravel()
    if len(axes) != count:
        raise InputError(None, "ax", f"{count} axes" if count > 1 else "one axes", str(len(axes)))
    return axes[0].figure, axes


def _table(title, rows):
    cells = "".join(
        f"<tr><th style='text-align:left'>{escape(str(k))}</th><td style='text-align:left'>{escape(str(v))}</td></tr>"
        for k, v in rows
    )
    return f"<table><caption style='text-align:left;font-weight:bold'>{escape(title)}</caption>{cells}</table>"


def _flat(values, prefix=""):
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def section_html(section):
    return _table("Section, per metre of span; y and lift up, θ nose-up", _flat(section.to_dict()))


def derivatives_html(table):
    low, high = table.tested_range
    rows = [
        ("width B", f"{table.width_m:.4f} m"),
        ("derivatives", ", ".join(table.to_numpy())),
        ("tested K = ωB/V", f"{low:.3f} to {high:.3f}"),
        ("source", table.source),
    ]
    return _table(table.name, rows)


def model_html(model):
    low, high = model.tested_range
    rows = [("fit", model.method), ("states", model.states), ("tested K = ωB/V", f"{low:.3f} to {high:.3f}")]
    report = model.report
    if report:
        for entry in report["entries"]:
            rms = entry["relative_rms"]
            if rms is not None:
                rows.append((f"residual {entry['force']} by {entry['motion']}", f"{100 * rms:.1f} %"))
    rows += [("note", note) for note in model.notes]
    return _table(model.kind, rows)


def onset_html(onset):
    rows = [("method", onset.method)]
    if onset.frequency_hz is not None:
        rows += [("frequency", f"{onset.frequency_hz:.4f} Hz"), ("V* = V/(fB)", f"{onset.reduced_velocity:.3f}")]
    if onset.no_interval:
        rows.append(("no 95 % interval", onset.no_interval))
    rows += [("warning", warning) for warning in onset.warnings]
    return _table(onset.headline, rows)


def sweep_html(sweep):
    speed = np.asarray(sweep.speed_m_s)
    rows = [("wind speeds", f"{len(speed)}, {speed.min():g} to {speed.max():g} m/s")]
    for name, damping in zip(sweep.modes, sweep.damping_ratio.T):
        known = damping[np.isfinite(damping)]
        if known.size:
            rows.append((f"damping, {name} mode", f"{100 * known.min():.2f} to {100 * known.max():.2f} %"))
    return _table("Modes over wind speed", rows)


def monte_carlo_html(result):
    rows = list(result.counts.items())
    unknown = {q["probability"]: f"{result.counts['samples']} samples do not tell" for q in result.to_dict()["quantiles"] if q["too_few_samples"]}
    said = [(p, f"{v:.2f} m/s" if v is not None else unknown.get(p, "not known")) for p, v in result.quantiles]
    rows += [(f"{100 * p:g} % flutter at or below", text) for p, text in said]
    if result.probability:
        p, low, high = result.probability
        rows.append(("below the design speed", f"{p:.3e} ({low:.3e} to {high:.3e})"))
    if result.verdict:
        rows.append(("of the model itself", result.verdict["explanation"]))
    return _table("Distribution of the flutter onset", rows)


def bridge_html(bridge):
    rows = [("nodes", f"{len(bridge.nodes)}, {bridge.along_m[0]:g} to {bridge.along_m[-1]:g} m along the girder")]
    modes = zip(bridge.modes, bridge.frequency_hz, bridge.damping_ratio)
    rows += [(f"mode {n}", f"{f:.4f} Hz, damping {100 * z:.2f} %") for n, f, z in modes]
    rows += [("note", note) for note in bridge.notes]
    return _table(bridge.name, rows)


def buffeting_html(found):
    words = zip(found.nodes, found.rms, found.expected_peak_factor)
    text = "RMS vertical {:.4f} m, lateral {:.4f} m, rotation {:.3f} deg; expected peaks {:.2f}, {:.2f}, {:.2f} times as large"
    rows = [(f"node {n}", text.format(r[0], r[1], np.degrees(r[2]), *p)) for n, r, p in words]
    return _table(f"Response to turbulence at {found.speed_m_s:g} m/s", rows)


def bridge_plot(bridge, modes=6, *, ax=None):
    count = min(modes, len(bridge.modes))
    figure, panels = _panels(ax, count, figsize=(7, 1.2 * count))
    for i, axes in enumerate(panels):
        scale = np.abs(bridge.shapes[i]).max(axis=0)
        largest = max(scale[:2].max(), np.finfo(float).tiny)
        axes.plot(bridge.along_m, bridge.shapes[i, :, 0] / largest, color=COLOURS[0], label="vertical")
        axes.plot(bridge.along_m, bridge.shapes[i, :, 1] / largest, color=COLOURS[2], linestyle="-.", label="lateral")
        turn = bridge.shapes[i, :, 2] / max(scale[2], np.finfo(float).tiny)
        axes.plot(bridge.along_m, turn, color=COLOURS[1], linestyle="--", label="rotation, scaled by itself")
        axes.set_ylabel(f"{bridge.modes[i]}: {bridge.frequency_hz[i]:.3f} Hz", fontsize=8)
    panels[0].legend(fontsize=8, ncols=3)
    axes.set_xlabel("along the girder (m)")
    return figure


def sweep_plot(sweep, onset=None, *, ax=None):
    figure, (above, below) = _panels(ax, 2)
    for i, name in enumerate(sweep.modes):
        style = {"color": COLOURS[i % 7], "linestyle": DASHES[i % 4], "label": f"{name} mode"}
        above.plot(sweep.speed_m_s, sweep.frequency_hz[:, i], **style)
        below.plot(sweep.speed_m_s, 100 * sweep.damping_ratio[:, i], **style)
    below.axhline(0, color="0.5", linewidth=0.8)
    if onset is not None and onset.speed_m_s is not None:
        for axes in (above, below):
            axes.axvline(onset.speed_m_s, color="0.3", linestyle=":")
            if onset.interval:
                axes.axvspan(*onset.interval, color="0.3", alpha=0.15)
        above.set_title(onset.headline)
    above.set_ylabel("frequency (Hz)")
    below.set_ylabel("damping ratio (%)")
    below.set_xlabel("wind speed V (m/s)")
    above.legend()
    return figure


def motion_plot(motion, *, ax=None):
    figure, panels = _panels(ax, len(motion.dofs))
    for i, (name, axes) in enumerate(zip(motion.dofs, panels)):
        unit, scale = ("deg", 180 / np.pi) if name == "torsion" else ("mm", 1e3)
        axes.plot(motion.time_s, scale * motion.displacement[:, i], color=COLOURS[0])
        axes.set_ylabel(f"{name} ({unit})")
    axes.set_xlabel("time (s)")
    return figure


def monte_carlo_plot(result, *, ax=None):
    figure, (axes,) = _panels(ax)
    edges, counts = result.histogram
    axes.stairs(counts, edges, fill=True, color=COLOURS[0], alpha=0.6)
    axes.set_xlabel("onset speed (m/s)")
    axes.set_ylabel("samples")
    return figure


def _of_model(model, v_hat):
    """Derivatives of a model over V̂: G = K² (D_real + i D_imaginary), so that each is V̂² times a part of G."""
    matrix = model.transfer(1 / v_hat) * (v_hat**2)[:, None, None]
    names = {
        ("vertical", "vertical"): "H4 H1", ("vertical", "torsion"): "H3 H2",
        ("torsion", "vertical"): "A4 A1", ("torsion", "torsion"): "A3 A2",
        ("vertical", "lateral"): "H6 H5", ("torsion", "lateral"): "A6 A5",
        ("lateral", "lateral"): "P4 P1", ("lateral", "torsion"): "P3 P2", ("lateral", "vertical"): "P6 P5",
    }
    found = {}
    for i, force in enumerate(model.dofs):
        for j, motion in enumerate(model.dofs):
            real, imaginary = names[force, motion].split()
            found[real], found[imaginary] = matrix[:, i, j].real, matrix[:, i, j].imag
    return found


def _derivatives_figure(measured, models, ax):
    order = [f"{letter}{n}" for letter in "HAP" for n in range(1, 7)]
    curves = []
    for name, model in models.items():
        low, high = model.tested_range
        v_hat = np.linspace(1 / high, 1 / low, 200)
        curves.append((name, v_hat, _of_model(model, v_hat)))
    present = [d for d in order if d in measured or any(d in c for _, _, c in curves)]
    if ax is None:
        rows = -(-len(present) // 4)
        figure, panels = _pyplot().subplots(rows, 4, sharex=True, layout="constrained", figsize=(11, 2.3 * rows))
        panels = panels.ravel()
    else:
        figure, panels = _panels(ax, len(present))
    for axes, name in zip(panels, present):
        if name in measured:
            axes.plot(measured[name][:, 1], measured[name][:, 2], "o", color="black", markersize=3, label="measured")
        for i, (label, v_hat, values) in enumerate(curves):
            if name in values:
                axes.plot(v_hat, values[name], color=COLOURS[i % 7], linestyle=DASHES[i % 4], label=label)
        axes.axhline(0, color="0.7", linewidth=0.6)
        axes.set_title(f"{name}*", fontsize=10)
    for axes in panels[len(present):]:
        axes.set_visible(False)
    if ax is None:
        figure.supxlabel("V̂ = V/(ωB)")
    panels[0].legend(fontsize=8)
    return figure


def derivatives_plot(table, models=(), *, ax=None):
    named = models if isinstance(models, dict) else {m.kind: m for m in np.atleast_1d(np.asarray(models, object))}
    return _derivatives_figure(table.to_numpy(), named, ax)


def model_plot(model, derivatives=None, *, ax=None):
    return _derivatives_figure(derivatives.to_numpy() if derivatives is not None else {}, {model.kind: model}, ax)
