//! Error against time: what every technique costs on a scene and a camera path, and the error that is left.
//!
//! A few frames are rendered by each technique of one table, with several seeds, and compared with references of known
//! noise. Unbiased oracle estimates at pixels of full-size frames show whether a technique is biased, and pairs of
//! consecutive frames how much it flickers. The irradiance cache is baked once, for all techniques that use it, and
//! each of their frames is charged its part of the time.

mod advice;
mod baked_cache;
mod bias;
mod error;
mod findings;
mod flicker;
mod foreign;
mod inputs;
mod measure;
mod pictures;
mod progress;
mod reference;
mod seconds;
mod technique;
mod text;

pub use baked_cache::BakeCost;
pub use bias::BiasRow;
pub use error::ReportError;
pub use findings::Report;
pub use flicker::FlickerRow;
pub use foreign::check_free_for_report;
pub use inputs::Inputs;
pub use measure::Measurement;
pub use reference::ReferenceRow;
pub use technique::{Technique, techniques};

use baked_cache::BakedCache;
use inputs::pixels;
use pictures::strip_of;
use progress::Progress;

use crate::bake::Listener;
use crate::drawing::chart::Chart;
use crate::metrics::Reference;
use crate::storage::Folder;

/// Measures everything, on the threads of the current pool, and writes `report.csv`, `report.json`,
/// `report.md`, `curves` and `flicker` as SVG and PNG, and a strip for each curve.
pub fn report(inputs: &Inputs, listener: Listener) -> Result<Report, ReportError> {
    let techniques = techniques();
    let mut progress = Progress::new(work(inputs, &techniques), listener);
    let folder = Folder::create(inputs.folder)?;
    let strips = Folder::create(&inputs.folder.join("strips"))?;
    // What is written last can be written.
    drop(folder.part_file("report.md")?);

    let references = reference::references(inputs, &mut progress)?;
    let cache = BakedCache::new(inputs, &mut progress);
    let mut measurements: Vec<Measurement> = Vec::new();
    for (number, technique) in techniques.iter().enumerate() {
        let (measured, picture) =
            measure::measure(inputs, &cache, technique, &references, &mut progress);
        let next = techniques.get(number + 1);
        if next.is_none_or(|next| next.curve != technique.curve) {
            let strip = pictures::strip(inputs, &picture, &references[0].1)?;
            strips.write_atomic(strip_of(technique.curve), &strip)?;
        }
        measurements.push(measured);
    }
    let bias = bias::bias(inputs, &cache, &techniques, &mut progress);
    let flicker = flicker::flicker(inputs, &cache, &mut progress);

    let quality = |(frame, reference): &(u32, Reference)| ReferenceRow {
        size: (reference.mean().width(), reference.mean().height()),
        frame: *frame,
        rel_mse: reference.rel_mse(inputs.exposure()),
    };
    let full_size = inputs.full_size();
    let references: Vec<ReferenceRow> = references.iter().map(quality).collect();
    let mut advice: Vec<String> = technique::TARGETS
        .map(|target| advice::advice(&techniques, &measurements, &bias, target, full_size))
        .to_vec();
    advice.extend(bias::advice(&bias));
    advice.extend(flicker::advice(&flicker));
    advice.extend(inputs.caveat());
    advice.extend(reference::advice(inputs, &references));
    let report = Report {
        title: inputs.title.clone(),
        full_size,
        frames: inputs.frames.clone(),
        seeds: inputs.seeds,
        advice,
        bake: cache.bake,
        measurements,
        references,
        bias,
        flicker,
    };
    let chart = |name: &str, chart: Chart| -> Result<(), ReportError> {
        folder.write_atomic(format!("{name}.svg"), chart.to_svg()?.as_bytes())?;
        Ok(folder.write_atomic(format!("{name}.png"), &chart.to_png()?)?)
    };
    folder.write_atomic("report.csv", text::csv(&report).as_bytes())?;
    folder.write_atomic("report.json", &text::json(&report)?)?;
    folder.write_atomic("report.md", text::markdown(&report).as_bytes())?;
    chart("curves", pictures::curves(inputs, &report.measurements))?;
    chart("flicker", pictures::flicker_curve(inputs, &report.flicker))?;
    Ok(report)
}

/// About how many paths the whole report traces.
fn work(inputs: &Inputs, techniques: &[Technique]) -> f64 {
    let frames = inputs.frames.len() as f64;
    let of_pixel: f64 = techniques.iter().map(Technique::paths).sum();
    of_pixel * pixels(inputs.size) * frames * f64::from(inputs.seeds)
        + reference::work(inputs) * frames
        + baked_cache::work(inputs)
        + bias::work(inputs, techniques)
        + flicker::work(inputs.path.timeline().frame_count())
}
