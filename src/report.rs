//! Figures and pages from result structs; nothing is computed here.
//!
//! A [`Figure`] is SVG text; with the feature `png` also an image, drawn with the font that is part of the program. The same data always give the same bytes. Colours are those of Okabe and Ito, told apart by colour-blind
//! readers; what differs in colour only also differs in a line style or a marker where two kinds of thing meet.

mod axes_sketch;
mod axis;
mod bridge_figures;
mod derivatives_figure;
mod drawing;
mod flutter_figures;
mod font;
mod heat_map;
mod labels;
mod legend;
mod page_head;
mod panel;
mod processing_figures;
#[cfg(feature = "png")]
mod raster;
mod reliability_figure;
mod response_figures;
mod scene;
mod sections_page;
mod study_page;
mod style;
mod summary_figure;
mod thesis_figures;
mod transfer_figure;
mod vocabulary;
mod wind_figures;

pub(crate) use axes_sketch::axes_sketch;
pub(crate) use bridge_figures::{
    bridge_curves_figure, bridge_roots_figure, flutter_motion_figure, modes_figure,
};
pub use derivatives_figure::{DerivativePlot, derivatives_figure};
pub(crate) use flutter_figures::root_locus_figure;
pub use flutter_figures::vf_vg_figure;
pub(crate) use heat_map::{HeatMap, heat_map_figure};
pub use legend::PlottedSeries;
pub(crate) use page_head::rendered;
pub(crate) use processing_figures::processing_figure;
#[cfg(feature = "png")]
pub use raster::PNG_SCALE;
pub(crate) use reliability_figure::onset_distribution_figure;
pub use response_figures::{GrowthPanel, TimePanel, growth_figure, time_history_figure};
pub(crate) use response_figures::{metrics_figure, scaled_history_figure};
pub use scene::Figure;
pub(crate) use sections_page::{PageSection, SectionsPage, sections_of};
pub(crate) use study_page::{PageCurve, PageFigure, StudyPage};
pub(crate) use summary_figure::summary_figure;
pub use thesis_figures::{first_order_figures, laguerre_figures};
pub(crate) use transfer_figure::{TransferCurve, TransferPlot, transfer_figure};
pub(crate) use wind_figures::{
    buffeting_rms_figure, buffeting_spectra_figure, envelope_figure, equilibrium_figure, shown_in,
};
