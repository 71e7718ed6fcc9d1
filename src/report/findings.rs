//! What a report finds.

use super::baked_cache::BakeCost;
use super::bias::BiasRow;
use super::flicker::FlickerRow;
use super::measure::Measurement;
use super::reference::ReferenceRow;
use serde::Serialize;

/// What a report finds.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The title.
    pub title: String,
    /// Columns and rows of the sequence's own frames.
    pub full_size: (u32, u32),
    /// The frames that were rendered.
    pub frames: Vec<u32>,
    /// How often each technique rendered each frame.
    pub seeds: u32,
    /// The cheapest settings, in words.
    pub advice: Vec<String>,
    /// The cost of the irradiance cache.
    pub bake: BakeCost,
    /// Every technique, in the order of the table.
    pub measurements: Vec<Measurement>,
    /// The references that errors are relative to.
    pub references: Vec<ReferenceRow>,
    /// The bias of techniques.
    pub bias: Vec<BiasRow>,
    /// The flicker of pairs of frames.
    pub flicker: Vec<FlickerRow>,
}
