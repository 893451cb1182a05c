//! The files that commands of a bridge leave and its page takes up, and the branches they draw in colour.

use crate::flutter::ModeShare;

/// The FMU of a bridge.
pub(crate) const BRIDGE_FMU: &str = "bridge.fmu";
/// Stem of the figure of frequencies and damping ratios.
pub(crate) const FLUTTER_FIGURE: &str = "bridge_flutter";
/// Stem of the figure of eigenvalues.
pub(crate) const ROOTS_FIGURE: &str = "bridge_roots";
/// Stem of the figure of derivatives of a section, followed by its number.
pub(crate) const DERIVATIVES_FIGURE: &str = "bridge_derivatives_";
/// Stem of the figure of the motion at the onset.
pub(crate) const MOTION_FIGURE: &str = "flutter_motion";
/// Stem of the figure of the motion over time.
pub(crate) const RESPONSE_FIGURE: &str = "flutter_response";
/// The page of a response to turbulence.
pub(crate) const BUFFETING_PAGE: &str = "buffeting.html";
/// Frequencies and damping ratios as numbers.
pub(crate) const CURVES: &str = "bridge_curves.csv";
/// Modes that are drawn in colour.
const SHOWN: usize = 6;

/// Modes with less of the kinetic energy at the onset take no part.
pub(crate) const NAMED_SHARE: f64 = 1e-3;

/// The branches of the modes that take part in the flutter.
pub(crate) fn taking_part(shares: &[ModeShare]) -> Vec<String> {
    let named = shares.iter().filter(|m| m.energy_share >= NAMED_SHARE);
    named.map(|m| format!("mode {}", m.mode)).collect()
}

/// The branches of the modes with the largest shares of the energy, the one that flutters among them.
pub(crate) fn shown_modes(shares: &[ModeShare], fluttering: Option<&str>) -> Vec<String> {
    let named = |m: &ModeShare| format!("mode {}", m.mode);
    let mut shown: Vec<String> = shares.iter().take(SHOWN).map(named).collect();
    if let (Some(last), Some(branch)) = (shown.last().cloned(), fluttering)
        && !shown.iter().any(|s| s == branch)
    {
        shown.retain(|s| *s != last);
        shown.push(branch.to_owned());
    }
    shown
}
